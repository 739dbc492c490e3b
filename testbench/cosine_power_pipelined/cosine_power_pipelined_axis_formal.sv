// cosine_power_pipelined_axis_formal: formal properties of cosine_power_pipelined_axis
//
// For formal tools only. All inputs are arbitrary, also those from the sender. A stub with the
// handshake of the core replaces the core: points leave its 10 stages in the order in which
// they came, with arbitrary results. The core has this handshake by the proof of
//   cosine_power_pipelined_formal.sv
// To prove the properties, run in a directory with the files of both folders:
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
    reg [9:0] points;  // the stages that hold a point; the first stage is bit 0
    reg [23:0] shown;
    assign out_valid = points[9];
    assign in_ready = out_ready | ~out_valid;
    always @(posedge clk) begin
        if (!rst_n) points <= 0;
        else if (in_ready) points <= {points, in_valid};
        if (in_ready) shown <= any;
    end
    assign red_out = shown[7:0];
    assign green_out = shown[15:8];
    assign blue_out = shown[23:16];
endmodule

// Registers replace the memory of the delay line of tlast and tuser.
module cosine_power_pipelined_delay #(
    parameter WIDTH = 8,
    parameter WORDS = 2,
    parameter BITS = 1
) (
    input wire clk, rst_n, enable,
    input wire [WIDTH-1:0] entering,
    output wire [WIDTH-1:0] leaving
);
    reg [WIDTH*(WORDS+1)-1:0] words;
    assign leaving = words[WIDTH*(WORDS+1)-1:WIDTH*WORDS];
    always @(posedge clk) if (enable) words <= {words, entering};
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

    // Internal signals of the design that the assertions read.
    (* hierconn *) wire \dut.held ;
    (* hierconn *) wire [23:0] \dut.held_results ;
    (* hierconn *) wire [1:0] \dut.held_side ;
    (* hierconn *) wire [19:0] \dut.side.words ;
    (* hierconn *) wire [1:0] \dut.results_side ;
    (* hierconn *) wire [9:0] \dut.core.points ;
    (* hierconn *) wire \dut.core.rst_n ;
    (* hierconn *) wire \dut.core.in_valid ;
    (* hierconn *) wire \dut.core.in_ready ;
    (* hierconn *) wire \dut.core.out_valid ;
    (* hierconn *) wire \dut.core.out_ready ;
    (* hierconn *) wire [20:0] \dut.core.cos_gamma ;
    (* hierconn *) wire [9:0] \dut.core.exponent ;
    (* hierconn *) wire [7:0] \dut.core.red ;
    (* hierconn *) wire [7:0] \dut.core.green ;
    (* hierconn *) wire [7:0] \dut.core.blue ;
    (* hierconn *) wire [7:0] \dut.core.red_out ;
    (* hierconn *) wire [7:0] \dut.core.green_out ;
    (* hierconn *) wire [7:0] \dut.core.blue_out ;

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!aresetn);

    wire give = m_axis_tvalid && m_axis_tready;
    wire leaves = dut.core.out_valid && dut.core.out_ready;

    // Follows one arbitrary point through the stages.
    (* anyseq *) reg marks;
    reg was_marked;
    wire marked = marks && !was_marked && s_axis_tvalid && s_axis_tready;
    reg [9:0] mark;
    reg [1:0] its_side;
    always @(posedge aclk) begin
        if (!aresetn) begin
            was_marked <= 0;
            mark <= 0;
        end else begin
            if (marked) was_marked <= 1;
            if (dut.core.out_ready || !dut.core.out_valid) mark <= {mark, marked};
        end
        if (marked) its_side <= {s_axis_tlast, s_axis_tuser};
    end

    // The numbers of points that left the core and that the receiver accepted, modulo 4. Fewer than
    // 4 can be in between. `chosen` is the number of one arbitrary point.
    reg [1:0] left;
    reg [1:0] given;
    (* anyconst *) reg [1:0] chosen;
    reg [1:0] its_last_side;
    reg [23:0] its_results;
    wire [23:0] results = {
        dut.core.blue_out,
        dut.core.green_out,
        dut.core.red_out
    };
    always @(posedge aclk) begin
        if (!aresetn) begin
            left <= 0;
            given <= 0;
        end else begin
            left <= left + leaves;
            given <= given + give;
        end
        if (leaves && left == chosen) begin
            its_last_side <= dut.results_side;
            its_results <= results;
        end
    end

    always @(posedge aclk) if (!$initstate) begin
        if ($past(aresetn)) begin
            // A valid transfer stays unchanged until the receiver accepts it.
            if ($past(m_axis_tvalid && !m_axis_tready)) begin
                assert (m_axis_tvalid);
                assert (m_axis_tdata == $past(m_axis_tdata));
                assert (m_axis_tuser == $past(m_axis_tuser));
                assert (m_axis_tlast == $past(m_axis_tlast));
            end
            // Progress: results that leave the core are valid on m_axis in the next clock, whether
            // or not the receiver is ready. The core advances in the clock after the receiver
            // accepted a transfer or could have accepted one.
            if ($past(leaves)) assert (m_axis_tvalid);
            if ($past(m_axis_tready || !m_axis_tvalid)) assert (dut.core.out_ready);
        end else begin
            assert (!m_axis_tvalid && dut.core.out_ready);
        end
        // The core gets the operands in the clock in which they are sent.
        assert (dut.core.rst_n == aresetn);
        assert (dut.core.in_valid == s_axis_tvalid);
        assert (dut.core.in_ready == s_axis_tready);
        assert (dut.core.cos_gamma == s_axis_tdata[20:0]);
        assert (dut.core.exponent == s_axis_tdata[33:24]);
        assert (dut.core.red == s_axis_tdata[47:40]);
        assert (dut.core.green == s_axis_tdata[55:48]);
        assert (dut.core.blue == s_axis_tdata[63:56]);
        // tuser and tlast advance with their point.
        if (mark[9]) assert (dut.core.out_valid && dut.results_side == its_side);
        // The transfers on m_axis carry the results of the core in the same order, each with its
        // tuser and tlast.
        if (give && given == chosen) begin
            assert (m_axis_tdata == its_results);
            assert ({m_axis_tlast, m_axis_tuser} == its_last_side);
        end
    end

    // Invariants that make the properties inductive.
    always @* if (!$initstate) begin
        assert ((mark & ~dut.core.points) == 0);
        if (!was_marked) assert (mark == 0);
        if (mark[0]) assert (dut.side.words[1:0] == its_side);
        if (mark[1]) assert (dut.side.words[3:2] == its_side);
        if (mark[2]) assert (dut.side.words[5:4] == its_side);
        if (mark[3]) assert (dut.side.words[7:6] == its_side);
        if (mark[4]) assert (dut.side.words[9:8] == its_side);
        if (mark[5]) assert (dut.side.words[11:10] == its_side);
        if (mark[6]) assert (dut.side.words[13:12] == its_side);
        if (mark[7]) assert (dut.side.words[15:14] == its_side);
        if (mark[8]) assert (dut.side.words[17:16] == its_side);
        if (mark[9]) assert (dut.side.words[19:18] == its_side);
        assert (left - given == {1'b0, dut.held} + m_axis_tvalid);
        if (dut.held) assert (m_axis_tvalid);
        if (m_axis_tvalid && given == chosen) begin
            assert (m_axis_tdata == its_results);
            assert ({m_axis_tlast, m_axis_tuser} == its_last_side);
        end
        if (dut.held && given + 2'd1 == chosen) begin
            assert (dut.held_results == its_results);
            assert (dut.held_side == its_last_side);
        end
    end
endmodule

`default_nettype wire
