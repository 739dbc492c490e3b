// threshold_levels_axis_formal: formal properties of threshold_levels_axis
//
// For formal tools only. All inputs are arbitrary, also those from the sender. A stub with the
// handshake of the core replaces the core: busy is high from the clock after start to done, and
// during that time the stub shows one result, at an arbitrary time and with arbitrary values.
// To prove the properties, run in a directory with the files of both folders:
//   $ yosys -q threshold_levels_axis_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 threshold_levels_axis_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 threshold_levels_axis_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

module threshold_levels (
    input wire clk,
    input wire rst_n,
    input wire start,
    input wire [20:0] cos_gamma,
    input wire cos_gamma_write,
    input wire [9:0] exponent,
    input wire exponent_write,
    input wire [7:0] red,
    input wire red_write,
    input wire [7:0] green,
    input wire green_write,
    input wire [7:0] blue,
    input wire blue_write,
    output wire valid,
    output wire busy,
    output wire done,
    output wire [7:0] red_out,
    output wire [7:0] green_out,
    output wire [7:0] blue_out
);
    (* anyseq *) reg shows;
    (* anyseq *) reg ends;
    (* anyseq *) reg [7:0] any_red_out;
    assign red_out = any_red_out;
    (* anyseq *) reg [7:0] any_green_out;
    assign green_out = any_green_out;
    (* anyseq *) reg [7:0] any_blue_out;
    assign blue_out = any_blue_out;
    reg run;
    reg computing;
    always @(posedge clk) computing <= rst_n & (run ? computing & ~valid : start);
    wire ended = ~computing | valid;
    assign busy = run;
    assign valid = run & computing & shows;
    assign done = run & ends & ended;
    always @(posedge clk) run <= rst_n & (run ? ~done : start);

    // A computation starts only after the computation before it has ended, and loads all operands.
    always @(posedge clk) if (!$initstate && start) begin
        assert (!run);
        assert (cos_gamma_write);
        assert (exponent_write);
        assert (red_write);
        assert (green_write);
        assert (blue_write);
    end
    always @* if (!$initstate && computing) assert (run);
endmodule

module threshold_levels_axis_formal (
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

    threshold_levels_axis dut (
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
    (* hierconn *) wire \dut.start ;
    (* hierconn *) wire \dut.valid ;
    (* hierconn *) wire \dut.waiting ;
    (* hierconn *) wire [63:0] \dut.operands ;
    (* hierconn *) wire \dut.operands_user ;
    (* hierconn *) wire \dut.user ;
    (* hierconn *) wire \dut.core.computing ;
    (* hierconn *) wire \dut.core.run ;
    (* hierconn *) wire \dut.operands_last ;
    (* hierconn *) wire \dut.last ;
    (* hierconn *) wire \dut.held ;
    (* hierconn *) wire \dut.held_last ;
    (* hierconn *) wire \dut.held_user ;
    (* hierconn *) wire [23:0] \dut.held_results ;
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

    // The numbers of points that were accepted, started, computed and that came out, modulo 8.
    // Fewer than 8 points can be on their way.
    reg [2:0] taken;
    reg [2:0] begun;
    reg [2:0] computed;
    reg [2:0] given;
    wire accept = s_axis_tvalid && s_axis_tready;
    wire give = m_axis_tvalid && m_axis_tready;
    always @(posedge aclk) begin
        if (!aresetn) begin
            taken <= 0;
            begun <= 0;
            computed <= 0;
            given <= 0;
        end else begin
            taken <= taken + accept;
            begun <= begun + dut.start;
            computed <= computed + dut.valid;
            given <= given + give;
        end
    end

    // One arbitrary point, with its operands, tuser and results.
    (* anyconst *) reg [2:0] chosen;
    wire [2:0] chosen_line = chosen;
    reg its_last;
    reg [63:0] its_operands;
    reg [0:0] its_user;
    reg [25:0] its_results;
    wire [23:0] results = {
        dut.core.blue_out,
        dut.core.green_out,
        dut.core.red_out
    };
    always @(posedge aclk) begin
        if (accept && taken == chosen_line) begin
            its_operands <= s_axis_tdata;
            its_user <= s_axis_tuser;
            its_last <= s_axis_tlast;
        end
        if (dut.valid && computed == chosen) its_results <= {its_user, its_last, results};
    end

    // Counts clocks without an accepted transfer although the core is idle and its results have
    // left.
    reg [1:0] waited;
    wire idle = !dut.core.run && m_axis_tready;
    always @(posedge aclk) begin
        if (!aresetn || !idle || s_axis_tready) waited <= 0;
        else waited <= waited + 1'b1;
    end

    always @(posedge aclk) if (!$initstate) begin
        if ($past(aresetn)) begin
            // Progress: a transfer waits only for the core and for the receiver.
            if ($past(s_axis_tready && !s_axis_tvalid)) assert (s_axis_tready);
            assert (waited <= 2);
            // A valid transfer stays unchanged until the receiver accepts it.
            if ($past(m_axis_tvalid && !m_axis_tready)) begin
                assert (m_axis_tvalid);
                assert (m_axis_tdata == $past(m_axis_tdata));
                assert (m_axis_tuser == $past(m_axis_tuser));
                assert (m_axis_tlast == $past(m_axis_tlast));
            end
            // m_axis_tvalid does not wait for m_axis_tready.
            if ($past(dut.valid)) assert (m_axis_tvalid);
        end else begin
            assert (!m_axis_tvalid && !s_axis_tready);
        end
        // The core computes with the operands that were sent, in the same order.
        if (dut.start && begun == chosen_line) begin
            assert (dut.core.cos_gamma == its_operands[20:0]);
            assert (dut.core.exponent == its_operands[33:24]);
            assert (dut.core.red == its_operands[47:40]);
            assert (dut.core.green == its_operands[55:48]);
            assert (dut.core.blue == its_operands[63:56]);
        end
        // The transfers on m_axis carry the results of the core in the same order, each with its
        // tuser and tlast.
        if (give && given == chosen) begin
            assert ({m_axis_tuser, m_axis_tlast, m_axis_tdata} == its_results);
        end
    end

    // Invariants that make the properties inductive.
    always @* if (!$initstate) begin
        assert (!(s_axis_tready && dut.waiting));
        if (waited != 0) assert (s_axis_tready || dut.waiting && !dut.held);
        if (waited == 2) assert (s_axis_tready || dut.core.run);
        assert (taken - begun == dut.waiting);
        if (dut.waiting && begun == chosen_line) begin
            assert (dut.operands == its_operands);
            assert (dut.operands_user == its_user);
            assert (dut.operands_last == its_last);
        end
        assert (begun - computed == dut.core.computing);
        assert (computed - given == {1'b0, dut.held} + m_axis_tvalid);
        if (dut.held) assert (m_axis_tvalid && !dut.core.computing);
        if (dut.core.computing && computed == chosen) begin
            assert (dut.user == its_user);
            assert (dut.last == its_last);
        end
        if (m_axis_tvalid && given == chosen) begin
            assert ({m_axis_tuser, m_axis_tlast, m_axis_tdata} == its_results);
        end
        if (dut.held && given + 3'd1 == chosen) begin
            assert ({dut.held_user, dut.held_last, dut.held_results} == its_results);
        end
    end
endmodule

`default_nettype wire
