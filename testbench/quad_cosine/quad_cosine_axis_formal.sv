// quad_cosine_axis_formal: formal properties of quad_cosine_axis
//
// For formal tools only. All inputs are arbitrary, also those from the sender. A stub with the
// handshake of the core replaces the core: busy is high from the clock after start to done, and
// during that time the stub shows length + 1 results, at arbitrary times and with arbitrary values.
// To prove the properties, run in a directory with the files of both folders:
//   $ yosys -q quad_cosine_axis_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 quad_cosine_axis_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 quad_cosine_axis_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

module quad_cosine (
    input wire clk,
    input wire rst_n,
    input wire start,
    input wire [7:0] amplitude,
    input wire amplitude_write,
    input wire signed [27:0] delta_zeta,
    input wire delta_zeta_write,
    input wire signed [27:0] zeta_start,
    input wire zeta_start_write,
    input wire [11:0] length,
    input wire length_write,
    input wire [9:0] exponent,
    input wire exponent_write,
    output wire valid,
    output wire busy,
    output wire done,
    output wire count,
    output wire accumulate,
    output wire write_angle,
    output wire [7:0] intensity_out
);
    (* anyseq *) reg shows;
    (* anyseq *) reg ends;
    (* anyseq *) reg any_count;
    assign count = any_count;
    (* anyseq *) reg any_accumulate;
    assign accumulate = any_accumulate;
    (* anyseq *) reg any_write_angle;
    assign write_angle = any_write_angle;
    (* anyseq *) reg [7:0] any_intensity_out;
    assign intensity_out = any_intensity_out;
    reg run;
    reg [12:0] to_come;
    always @(posedge clk) begin
        if (!rst_n) to_come <= 13'd0;
        else if (!run) to_come <= start ? {1'b0, length} + 13'd1 : 13'd0;
        else if (valid) to_come <= to_come - 13'd1;
    end
    wire computing = to_come != 13'd0;
    wire ended = valid ? to_come == 13'd1 : !computing;
    assign busy = run;
    assign valid = run & computing & shows;
    assign done = run & ends & ended;
    always @(posedge clk) run <= rst_n & (run ? ~done : start);

    // A computation starts only after the computation before it has ended, and loads all operands.
    always @(posedge clk) if (!$initstate && start) begin
        assert (!run);
        assert (amplitude_write);
        assert (delta_zeta_write);
        assert (zeta_start_write);
        assert (length_write);
        assert (exponent_write);
    end
    always @* if (!$initstate && computing) assert (run);
endmodule

// An abstract memory replaces the buffer. Only the word at one arbitrary address, `watched`, is
// stored. A read of any other address gives an arbitrary value.
module quad_cosine_axis_buffer #(
    parameter WIDTH = 1
) (
    input wire clk,
    input wire write,
    input wire [11:0] write_at,
    input wire [WIDTH-1:0] word,
    input wire read,
    input wire [11:0] read_at,
    output reg [WIDTH-1:0] out
);
    (* anyconst *) reg [11:0] watched;
    (* anyseq *) reg [WIDTH-1:0] other;
    reg [WIDTH-1:0] watched_word;
    always @(posedge clk) if (write && write_at == watched) watched_word <= word;
    always @(posedge clk) if (read) out <= read_at == watched ? watched_word : other;
endmodule

module quad_cosine_axis_formal (
    input wire aclk,
    input wire aresetn,
    input wire [103:0] s_axis_tdata,
    input wire [0:0] s_axis_tuser,
    input wire s_axis_tvalid,
    input wire m_axis_tready
);
    wire s_axis_tready;
    wire [7:0] m_axis_tdata;
    wire [0:0] m_axis_tuser;
    wire m_axis_tlast;
    wire m_axis_tvalid;

    quad_cosine_axis dut (
        .aclk(aclk),
        .aresetn(aresetn),
        .s_axis_tdata(s_axis_tdata),
        .s_axis_tuser(s_axis_tuser),
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
    (* hierconn *) wire [103:0] \dut.operands ;
    (* hierconn *) wire \dut.operands_user ;
    (* hierconn *) wire \dut.user ;
    (* hierconn *) wire \dut.core.computing ;
    (* hierconn *) wire \dut.core.run ;
    (* hierconn *) wire [12:0] \dut.core.to_come ;
    (* hierconn *) wire \dut.read ;
    (* hierconn *) wire [12:0] \dut.read_at ;
    (* hierconn *) wire [12:0] \dut.write_at ;
    (* hierconn *) wire [12:0] \dut.next_line ;
    (* hierconn *) wire [11:0] \dut.buffer.watched ;
    (* hierconn *) wire [9:0] \dut.buffer.watched_word ;
    (* hierconn *) wire [7:0] \dut.core.amplitude ;
    (* hierconn *) wire [27:0] \dut.core.delta_zeta ;
    (* hierconn *) wire [27:0] \dut.core.zeta_start ;
    (* hierconn *) wire [11:0] \dut.core.length ;
    (* hierconn *) wire [9:0] \dut.core.exponent ;
    (* hierconn *) wire [7:0] \dut.core.intensity_out ;

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!aresetn);

    // The numbers of lines that were accepted and started, and of points that came out, modulo more
    // than can be on their way. write_at is the number of the next point of the core.
    reg [1:0] taken;
    reg [1:0] begun;
    reg [12:0] given;
    wire accept = s_axis_tvalid && s_axis_tready;
    wire give = m_axis_tvalid && m_axis_tready;
    always @(posedge aclk) begin
        if (!aresetn) begin
            taken <= 0;
            begun <= 0;
            given <= 0;
        end else begin
            taken <= taken + accept;
            begun <= begun + dut.start;
            given <= given + give;
        end
    end

    // One arbitrary line, with its operands, tuser and results.
    (* anyconst *) reg [1:0] chosen_line;
    reg [103:0] its_operands;
    reg [0:0] its_user;
    reg [9:0] its_results;
    // Whether the transfer on m_axis comes from the watched address of the buffer.
    reg its_turn;
    reg [9:0] its_turn_results;
    wire [7:0] results = {
        dut.core.intensity_out
    };
    wire [12:0] stored = dut.write_at - dut.read_at;
    wire [12:0] reserved = dut.next_line - dut.read_at;
    wire [11:0] watched_from_read = dut.buffer.watched - dut.read_at[11:0];
    always @(posedge aclk) begin
        if (accept && taken == chosen_line) begin
            its_operands <= s_axis_tdata;
            its_user <= s_axis_tuser;
        end
        if (dut.valid && dut.write_at[11:0] == dut.buffer.watched) begin
            its_results <= {dut.user, dut.core.to_come == 1, results};
        end
        if (dut.read || m_axis_tready) begin
            its_turn <= dut.read && dut.read_at[11:0] == dut.buffer.watched;
        end
        if (dut.read) its_turn_results <= its_results;
    end

    // Counts clocks without an accepted transfer although the core is idle and its results have
    // left.
    reg [1:0] waited;
    wire idle = !dut.core.run && dut.write_at == dut.read_at;
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
            if ($past(dut.write_at != dut.read_at)) assert (m_axis_tvalid);
        end else begin
            assert (!m_axis_tvalid && !s_axis_tready);
        end
        // The core computes with the operands that were sent, in the same order.
        if (dut.start && begun == chosen_line) begin
            assert (dut.core.amplitude == its_operands[7:0]);
            assert (dut.core.delta_zeta == its_operands[35:8]);
            assert (dut.core.zeta_start == its_operands[67:40]);
            assert (dut.core.length == its_operands[83:72]);
            assert (dut.core.exponent == its_operands[97:88]);
        end
        // The transfers on m_axis carry the results of the core in the same order, each with its
        // tuser and tlast.
        if (give && its_turn) begin
            assert ({m_axis_tuser, m_axis_tlast, m_axis_tdata} == its_turn_results);
        end
    end

    // Invariants that make the properties inductive.
    always @* if (!$initstate) begin
        assert (!(s_axis_tready && dut.waiting));
        if (waited != 0) assert (s_axis_tready || dut.waiting);
        if (waited == 2) assert (s_axis_tready || dut.core.run);
        assert (taken - begun == dut.waiting);
        if (dut.waiting && begun == chosen_line) begin
            assert (dut.operands == its_operands);
            assert (dut.operands_user == its_user);
        end
        if (dut.core.computing && begun - 2'd1 == chosen_line) assert (dut.user == its_user);
        // The buffer has room for all points of the line that are still to come.
        assert (dut.next_line - dut.write_at == dut.core.to_come);
        assert (stored <= reserved);
        assert (reserved <= 13'h1000);
        // The points leave the buffer in order.
        assert (given + m_axis_tvalid == dut.read_at);
        if (watched_from_read < stored) assert (dut.buffer.watched_word == its_results);
        if (m_axis_tvalid && its_turn) begin
            assert ({m_axis_tuser, m_axis_tlast, m_axis_tdata} == its_turn_results);
        end
    end
endmodule

`default_nettype wire
