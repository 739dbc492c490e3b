// cosine_power_pipelined_axis_formal: what is proved of cosine_power_pipelined_axis
//
// For formal tools alone. All inputs are free, the sender's too. The core is abstracted to its
// handshake and its 10 stages: a point has any results. To prove it, from a directory that
// holds the files of both folders:
//   $ yosys -q cosine_power_pipelined_axis_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 cosine_power_pipelined_axis_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 cosine_power_pipelined_axis_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

module cosine_power_pipelined (
    input wire clk,
    input wire rst_n,
    input wire in_valid,
    input wire [20:0] cos_gamma,
    input wire [9:0] exponent,
    input wire [7:0] red,
    input wire [7:0] green,
    input wire [7:0] blue,
    input wire out_ready,
    output wire in_ready,
    output wire out_valid,
    output wire [7:0] red_out,
    output wire [7:0] green_out,
    output wire [7:0] blue_out
);
    (* anyseq *) reg [23:0] any;
    reg valid_10;
    reg [23:0] data_10;
    reg valid_9;
    reg [23:0] data_9;
    reg valid_8;
    reg [23:0] data_8;
    reg valid_7;
    reg [23:0] data_7;
    reg valid_6;
    reg [23:0] data_6;
    reg valid_5;
    reg [23:0] data_5;
    reg valid_4;
    reg [23:0] data_4;
    reg valid_3;
    reg [23:0] data_3;
    reg valid_2;
    reg [23:0] data_2;
    reg valid_1;
    reg [23:0] data_1;
    assign in_ready = out_ready | ~valid_10;
    assign out_valid = valid_10;
    always @(posedge clk) begin
        if (!rst_n) begin
            valid_10 <= 1'b0;
            valid_9 <= 1'b0;
            valid_8 <= 1'b0;
            valid_7 <= 1'b0;
            valid_6 <= 1'b0;
            valid_5 <= 1'b0;
            valid_4 <= 1'b0;
            valid_3 <= 1'b0;
            valid_2 <= 1'b0;
            valid_1 <= 1'b0;
        end else if (in_ready) begin
            valid_1 <= in_valid;
            valid_10 <= valid_9;
            valid_9 <= valid_8;
            valid_8 <= valid_7;
            valid_7 <= valid_6;
            valid_6 <= valid_5;
            valid_5 <= valid_4;
            valid_4 <= valid_3;
            valid_3 <= valid_2;
            valid_2 <= valid_1;
        end
        if (in_ready) begin
            data_1 <= any;
            data_10 <= data_9;
            data_9 <= data_8;
            data_8 <= data_7;
            data_7 <= data_6;
            data_6 <= data_5;
            data_5 <= data_4;
            data_4 <= data_3;
            data_3 <= data_2;
            data_2 <= data_1;
        end
    end
    assign red_out = data_10[7:0];
    assign green_out = data_10[15:8];
    assign blue_out = data_10[23:16];
endmodule

module cosine_power_pipelined_axis_formal (
    input wire aclk,
    input wire aresetn,
    input wire [63:0] s_axis_tdata,
    input wire [0:0] s_axis_tuser,
    input wire s_axis_tlast,
    input wire s_axis_tvalid,
    input wire m_axis_tready
);
    wire s_axis_tready;
    wire [23:0] m_axis_tdata;
    wire [0:0] m_axis_tuser;
    wire m_axis_tlast;
    wire m_axis_tvalid;

    cosine_power_pipelined_axis dut (
        .aclk(aclk),
        .aresetn(aresetn),
        .s_axis_tdata(s_axis_tdata),
        .s_axis_tuser(s_axis_tuser),
        .s_axis_tlast(s_axis_tlast),
        .s_axis_tvalid(s_axis_tvalid),
        .s_axis_tready(s_axis_tready),
        .m_axis_tdata(m_axis_tdata),
        .m_axis_tuser(m_axis_tuser),
        .m_axis_tlast(m_axis_tlast),
        .m_axis_tvalid(m_axis_tvalid),
        .m_axis_tready(m_axis_tready)
    );

    // Internal signals that the proof refers to.
    (* hierconn *) wire \dut.held ;
    (* hierconn *) wire [23:0] \dut.held_results ;
    (* hierconn *) wire [1:0] \dut.held_side ;
    (* hierconn *) wire [19:0] \dut.side ;
    (* hierconn *) wire [23:0] \dut.core.any ;
    (* hierconn *) wire [20:0] \dut.core.cos_gamma ;
    (* hierconn *) wire [9:0] \dut.core.exponent ;
    (* hierconn *) wire [7:0] \dut.core.red ;
    (* hierconn *) wire [7:0] \dut.core.green ;
    (* hierconn *) wire [7:0] \dut.core.blue ;
    (* hierconn *) wire \dut.core.valid_1 ;
    (* hierconn *) wire [23:0] \dut.core.data_1 ;
    (* hierconn *) wire \dut.core.valid_2 ;
    (* hierconn *) wire [23:0] \dut.core.data_2 ;
    (* hierconn *) wire \dut.core.valid_3 ;
    (* hierconn *) wire [23:0] \dut.core.data_3 ;
    (* hierconn *) wire \dut.core.valid_4 ;
    (* hierconn *) wire [23:0] \dut.core.data_4 ;
    (* hierconn *) wire \dut.core.valid_5 ;
    (* hierconn *) wire [23:0] \dut.core.data_5 ;
    (* hierconn *) wire \dut.core.valid_6 ;
    (* hierconn *) wire [23:0] \dut.core.data_6 ;
    (* hierconn *) wire \dut.core.valid_7 ;
    (* hierconn *) wire [23:0] \dut.core.data_7 ;
    (* hierconn *) wire \dut.core.valid_8 ;
    (* hierconn *) wire [23:0] \dut.core.data_8 ;
    (* hierconn *) wire \dut.core.valid_9 ;
    (* hierconn *) wire [23:0] \dut.core.data_9 ;
    (* hierconn *) wire \dut.core.valid_10 ;
    (* hierconn *) wire [23:0] \dut.core.data_10 ;

    // The reset comes first; the state before it is arbitrary.
    always @* if ($initstate) assume (!aresetn);

    // Points taken and given, modulo more than there can be under way.
    localparam COUNT = 4;
    reg [COUNT-1:0] taken;
    reg [COUNT-1:0] given;
    wire accept = s_axis_tvalid && s_axis_tready;
    wire give = m_axis_tvalid && m_axis_tready;
    always @(posedge aclk) begin
        if (!aresetn) begin
            taken <= 0;
            given <= 0;
        end else begin
            taken <= taken + accept;
            given <= given + give;
        end
    end

    // One of them, whichever, and what belongs to it.
    (* anyconst *) reg [COUNT-1:0] chosen;
    reg [1:0] its_side;
    reg [23:0] its_raw;
    always @(posedge aclk) begin
        if (accept && taken == chosen) begin
            its_side <= {s_axis_tlast, s_axis_tuser};
            its_raw <= dut.core.any;
        end
    end
    wire [7:0] its_red_out = its_raw[7:0];
    wire [7:0] its_green_out = its_raw[15:8];
    wire [7:0] its_blue_out = its_raw[23:16];
    wire [23:0] its_results = {
        its_blue_out,
        its_green_out,
        its_red_out
    };

    // The numbers of the points, which travel with them, and the one that is next in each place.
    reg [COUNT-1:0] offered_number;
    reg [COUNT-1:0] held_number;
    wire [COUNT-1:0] next_held = given + m_axis_tvalid;
    wire [COUNT-1:0] next_10 = dut.held ? held_number + 1'd1 : next_held;
    reg [COUNT-1:0] number_10;
    wire [COUNT-1:0] next_9 = dut.core.valid_10 ? number_10 + 1'd1 : next_10;
    reg [COUNT-1:0] number_9;
    wire [COUNT-1:0] next_8 = dut.core.valid_9 ? number_9 + 1'd1 : next_9;
    reg [COUNT-1:0] number_8;
    wire [COUNT-1:0] next_7 = dut.core.valid_8 ? number_8 + 1'd1 : next_8;
    reg [COUNT-1:0] number_7;
    wire [COUNT-1:0] next_6 = dut.core.valid_7 ? number_7 + 1'd1 : next_7;
    reg [COUNT-1:0] number_6;
    wire [COUNT-1:0] next_5 = dut.core.valid_6 ? number_6 + 1'd1 : next_6;
    reg [COUNT-1:0] number_5;
    wire [COUNT-1:0] next_4 = dut.core.valid_5 ? number_5 + 1'd1 : next_5;
    reg [COUNT-1:0] number_4;
    wire [COUNT-1:0] next_3 = dut.core.valid_4 ? number_4 + 1'd1 : next_4;
    reg [COUNT-1:0] number_3;
    wire [COUNT-1:0] next_2 = dut.core.valid_3 ? number_3 + 1'd1 : next_3;
    reg [COUNT-1:0] number_2;
    wire [COUNT-1:0] next_1 = dut.core.valid_2 ? number_2 + 1'd1 : next_2;
    reg [COUNT-1:0] number_1;
    wire [COUNT-1:0] next_0 = dut.core.valid_1 ? number_1 + 1'd1 : next_1;
    always @(posedge aclk) begin
        if (m_axis_tready || !m_axis_tvalid) offered_number <= dut.held ? held_number : number_10;
        if (!dut.held) held_number <= number_10;
        if (s_axis_tready) begin
            number_1 <= taken;
            number_10 <= number_9;
            number_9 <= number_8;
            number_8 <= number_7;
            number_7 <= number_6;
            number_6 <= number_5;
            number_5 <= number_4;
            number_4 <= number_3;
            number_3 <= number_2;
            number_2 <= number_1;
        end
    end

    always @(posedge aclk) if (!$initstate) begin
        if ($past(aresetn)) begin
            // What is offered stays, as it is, until it is taken.
            if ($past(m_axis_tvalid && !m_axis_tready)) begin
                assert (m_axis_tvalid);
                assert (m_axis_tdata == $past(m_axis_tdata));
                assert (m_axis_tuser == $past(m_axis_tuser));
                assert (m_axis_tlast == $past(m_axis_tlast));
            end
            // An offer does not wait for the receiver, nor the sender while transfers are taken.
            if ($past(dut.core.valid_10 && !dut.held)) assert (m_axis_tvalid);
            if ($past(m_axis_tready)) assert (s_axis_tready);
        end else begin
            assert (!m_axis_tvalid);
        end
        // The core computes with what is sent.
        assert (dut.core.cos_gamma == s_axis_tdata[20:0]);
        assert (dut.core.exponent == s_axis_tdata[33:24]);
        assert (dut.core.red == s_axis_tdata[47:40]);
        assert (dut.core.green == s_axis_tdata[55:48]);
        assert (dut.core.blue == s_axis_tdata[63:56]);
        // What is given is what the core computed, in its order, and tuser and tlast with it.
        if (give && given == chosen) begin
            assert (m_axis_tdata == its_results);
            assert ({m_axis_tlast, m_axis_tuser} == its_side);
        end

    end

    // Inductive invariants: every point is in one place, in the order in which they came.
    always @* if (!$initstate) begin
        assert (taken == next_0);
        assert (!dut.held || m_axis_tvalid);
        if (m_axis_tvalid) assert (offered_number == given);
        if (m_axis_tvalid && given == chosen) begin
            assert (m_axis_tdata == its_results);
            assert ({m_axis_tlast, m_axis_tuser} == its_side);
        end
        if (dut.held) assert (held_number == next_held);
        if (dut.held && held_number == chosen) begin
            assert (dut.held_results == its_results);
            assert (dut.held_side == its_side);
        end
        if (dut.core.valid_10) assert (number_10 == next_10);
        if (dut.core.valid_10 && number_10 == chosen) begin
            assert (dut.core.data_10 == its_raw);
            assert (dut.side[19:18] == its_side);
        end
        if (dut.core.valid_9) assert (number_9 == next_9);
        if (dut.core.valid_9 && number_9 == chosen) begin
            assert (dut.core.data_9 == its_raw);
            assert (dut.side[17:16] == its_side);
        end
        if (dut.core.valid_8) assert (number_8 == next_8);
        if (dut.core.valid_8 && number_8 == chosen) begin
            assert (dut.core.data_8 == its_raw);
            assert (dut.side[15:14] == its_side);
        end
        if (dut.core.valid_7) assert (number_7 == next_7);
        if (dut.core.valid_7 && number_7 == chosen) begin
            assert (dut.core.data_7 == its_raw);
            assert (dut.side[13:12] == its_side);
        end
        if (dut.core.valid_6) assert (number_6 == next_6);
        if (dut.core.valid_6 && number_6 == chosen) begin
            assert (dut.core.data_6 == its_raw);
            assert (dut.side[11:10] == its_side);
        end
        if (dut.core.valid_5) assert (number_5 == next_5);
        if (dut.core.valid_5 && number_5 == chosen) begin
            assert (dut.core.data_5 == its_raw);
            assert (dut.side[9:8] == its_side);
        end
        if (dut.core.valid_4) assert (number_4 == next_4);
        if (dut.core.valid_4 && number_4 == chosen) begin
            assert (dut.core.data_4 == its_raw);
            assert (dut.side[7:6] == its_side);
        end
        if (dut.core.valid_3) assert (number_3 == next_3);
        if (dut.core.valid_3 && number_3 == chosen) begin
            assert (dut.core.data_3 == its_raw);
            assert (dut.side[5:4] == its_side);
        end
        if (dut.core.valid_2) assert (number_2 == next_2);
        if (dut.core.valid_2 && number_2 == chosen) begin
            assert (dut.core.data_2 == its_raw);
            assert (dut.side[3:2] == its_side);
        end
        if (dut.core.valid_1) assert (number_1 == next_1);
        if (dut.core.valid_1 && number_1 == chosen) begin
            assert (dut.core.data_1 == its_raw);
            assert (dut.side[1:0] == its_side);
        end
    end
endmodule

`default_nettype wire
