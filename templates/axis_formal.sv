// ${ name }$_axis_formal: formal properties of ${ name }$_axis
//
// For formal tools only. All inputs are arbitrary, also those from the sender. A stub with the
// handshake of the core replaces the core: busy is high from the clock after start to done, and
<%- if line.is_some() %>
// during that time the stub shows length + 1 results, at arbitrary times and with arbitrary values.
<%- else %>
// during that time the stub shows one result, at an arbitrary time and with arbitrary values.
<%- endif %>
// To prove the properties, run in a directory with the files of both folders:
//   $ yosys -q ${ name }$_axis_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 ${ name }$_axis_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 ${ name }$_axis_formal.smt2
//
// Generated files belong to their user, without conditions.

`default_nettype none

module ${ name }$ (
<%- for line in stub_ports %>
    ${ line }$
<%- endfor %>
);
    (* anyseq *) reg shows;
    (* anyseq *) reg ends;
<%- for line in stub_free %>
    ${ line }$
<%- endfor %>
    reg run;
<%- if overlaps %>
    // The core accepts start in the clock of done too.
    wire idle = !run | done;
<%- endif %>
<%- if let Some(line) = line %>
    reg [${ line.width }$:0] to_come;
    always @(posedge clk) begin
        if (!rst_n) to_come <= ${ line.zero() }$;
        else if (<% if overlaps %>idle<% else %>!run<% endif %>) to_come <= start ? {1'b0, ${ line.length }$} + ${ line.one() }$ : ${ line.zero() }$;
        else if (valid) to_come <= to_come - ${ line.one() }$;
    end
    wire computing = to_come != ${ line.zero() }$;
    wire ended = valid ? to_come == ${ line.one() }$ : !computing;
<%- else %>
    reg computing;
    always @(posedge clk) computing <= rst_n & (<% if overlaps %>idle ? start : computing & ~valid<% else %>run ? computing & ~valid : start<% endif %>);
    wire ended = ~computing | valid;
<%- endif %>
    assign busy = run;
    assign valid = run & computing & shows;
    assign done = run & ends & ended;
<%- if overlaps %>
    always @(posedge clk) run <= rst_n & (idle ? start : run);
<%- else %>
    always @(posedge clk) run <= rst_n & (run ? ~done : start);
<%- endif %>

    // A computation starts only after the computation before it has ended, and loads all operands.
    always @(posedge clk) if (!$initstate && start) begin
        assert (<% if overlaps %>idle<% else %>!run<% endif %>);
<%- for strobe in strobes %>
        assert (${ strobe }$);
<%- endfor %>
    end
    always @* if (!$initstate && computing) assert (run);
endmodule

<%- if let Some(line) = line %>

// An abstract memory replaces the buffer. Only the word at one arbitrary address, `watched`, is
// stored. A read of any other address gives an arbitrary value.
module ${ name }$_axis_buffer #(
    parameter WIDTH = 1
) (
    input wire clk,
    input wire write,
    input wire [${ line.high() }$:0] write_at,
    input wire [WIDTH-1:0] word,
    input wire read,
    input wire [${ line.high() }$:0] read_at,
    output reg [WIDTH-1:0] out
);
    (* anyconst *) reg [${ line.high() }$:0] watched;
    (* anyseq *) reg [WIDTH-1:0] other;
    reg [WIDTH-1:0] watched_word;
    always @(posedge clk) if (write && write_at == watched) watched_word <= word;
    always @(posedge clk) if (read) out <= read_at == watched ? watched_word : other;
endmodule
<%- endif %>

module ${ name }$_axis_formal (
    input wire aclk,
    input wire aresetn,
    input wire [${ in_high }$:0] s_axis_tdata,
<%- if keep %>
    input wire [${ in_high / 8 }$:0] s_axis_tkeep,
<%- endif %>
    input wire [${ user_high }$:0] s_axis_tuser,
<%- if line.is_none() %>
    input wire s_axis_tlast,
<%- endif %>
    input wire s_axis_tvalid,
    input wire m_axis_tready
);
    wire s_axis_tready;
    wire [${ out_high }$:0] m_axis_tdata;
<%- if keep %>
    wire [${ out_high / 8 }$:0] m_axis_tkeep;
<%- endif %>
    wire [${ user_high }$:0] m_axis_tuser;
    wire m_axis_tlast;
    wire m_axis_tvalid;

    ${ name }$_axis dut (
        .aclk(aclk),
        .aresetn(aresetn),
        .s_axis_tdata(s_axis_tdata),
<%- if keep %>
        .s_axis_tkeep(s_axis_tkeep),
<%- endif %>
        .s_axis_tuser(s_axis_tuser),
<%- if line.is_none() %>
        .s_axis_tlast(s_axis_tlast),
<%- endif %>
        .s_axis_tvalid(s_axis_tvalid),
        .s_axis_tready(s_axis_tready),
        .m_axis_tdata(m_axis_tdata),
<%- if keep %>
        .m_axis_tkeep(m_axis_tkeep),
<%- endif %>
        .m_axis_tuser(m_axis_tuser),
        .m_axis_tlast(m_axis_tlast),
        .m_axis_tvalid(m_axis_tvalid),
        .m_axis_tready(m_axis_tready)
    );

    // Internal signals of the design that the assertions read.
<%- for wire in inside %>
    ${ wire }$
<%- endfor %>

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!aresetn);
<%- if keep %>

    always @* assert (&m_axis_tkeep);
<%- endif %>
<%- if let Some(line) = line %>

    // The numbers of lines that were accepted and started, and of points that came out, modulo more
    // than can be on their way. write_at is the number of the next point of the core.
    reg [1:0] taken;
    reg [1:0] begun;
    reg [${ line.width }$:0] given;
<%- else %>

    // The numbers of points that were accepted, started, computed and that came out, modulo 8.
    // Fewer than 8 points can be on their way.
    reg [2:0] taken;
    reg [2:0] begun;
    reg [2:0] computed;
    reg [2:0] given;
<%- endif %>
    wire accept = s_axis_tvalid && s_axis_tready;
    wire give = m_axis_tvalid && m_axis_tready;
    always @(posedge aclk) begin
        if (!aresetn) begin
            taken <= 0;
            begun <= 0;
<%- if line.is_none() %>
            computed <= 0;
<%- endif %>
            given <= 0;
        end else begin
            taken <= taken + accept;
            begun <= begun + dut.start;
<%- if line.is_none() %>
            computed <= computed + dut.valid;
<%- endif %>
            given <= given + give;
        end
    end

    // One arbitrary <% if line.is_some() %>line<% else %>point<% endif %>, with its operands, tuser and results.
<%- if line.is_some() %>
    (* anyconst *) reg [1:0] chosen_line;
<%- else %>
    (* anyconst *) reg [2:0] chosen;
    wire [2:0] chosen_line = chosen;
    reg its_last;
<%- endif %>
    reg [${ in_high }$:0] its_operands;
    reg [${ user_high }$:0] its_user;
    reg [${ packed_high }$:0] its_results;
<%- if line.is_some() %>
    // Whether the transfer on m_axis comes from the watched address of the buffer.
    reg its_turn;
    reg [${ packed_high }$:0] its_turn_results;
<%- endif %>
    wire [${ out_high }$:0] results = {
<%- for line in stub_packed %>
        ${ line }$
<%- endfor %>
    };
<%- if let Some(line) = line %>
    wire [${ line.width }$:0] stored = dut.write_at - dut.read_at;
    wire [${ line.width }$:0] reserved = dut.next_line - dut.read_at;
    wire [${ line.high() }$:0] watched_from_read = dut.buffer.watched - dut.read_at[${ line.high() }$:0];
<%- endif %>
    always @(posedge aclk) begin
        if (accept && taken == chosen_line) begin
            its_operands <= s_axis_tdata;
            its_user <= s_axis_tuser;
<%- if line.is_none() %>
            its_last <= s_axis_tlast;
<%- endif %>
        end
<%- if let Some(line) = line %>
        if (dut.valid && dut.write_at[${ line.high() }$:0] == dut.buffer.watched) begin
            its_results <= {dut.user, dut.core.to_come == 1, results};
        end
        if (dut.read || m_axis_tready) begin
            its_turn <= dut.read && dut.read_at[${ line.high() }$:0] == dut.buffer.watched;
        end
        if (dut.read) its_turn_results <= its_results;
<%- else %>
        if (dut.valid && computed == chosen) its_results <= {its_user, its_last, results};
<%- endif %>
    end

    // Counts clocks without an accepted transfer although the core is idle and its results have
    // left.
    reg [1:0] waited;
<%- if line.is_some() %>
    wire idle = !dut.core.run && dut.write_at == dut.read_at;
<%- else %>
    wire idle = !dut.core.run && m_axis_tready;
<%- endif %>
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
<%- if line.is_some() %>
            if ($past(dut.write_at != dut.read_at)) assert (m_axis_tvalid);
<%- else %>
            if ($past(dut.valid)) assert (m_axis_tvalid);
<%- endif %>
        end else begin
            assert (!m_axis_tvalid && !s_axis_tready);
        end
        // The core computes with the operands that were sent, in the same order.
        if (dut.start && begun == chosen_line) begin
<%- for check in stub_checks %>
            assert (${ check }$);
<%- endfor %>
        end
        // The transfers on m_axis carry the results of the core in the same order, each with its
        // tuser and tlast.
<%- if line.is_some() %>
        if (give && its_turn) begin
            assert ({m_axis_tuser, m_axis_tlast, m_axis_tdata} == its_turn_results);
        end
<%- else %>
        if (give && given == chosen) begin
            assert ({m_axis_tuser, m_axis_tlast, m_axis_tdata} == its_results);
        end
<%- endif %>
    end

    // Invariants that make the properties inductive.
    always @* if (!$initstate) begin
        assert (!(s_axis_tready && dut.waiting));
        if (waited != 0) assert (s_axis_tready || dut.waiting<% if line.is_none() %> && !dut.held<% endif %>);
        if (waited == 2) assert (s_axis_tready || dut.core.run);
        assert (taken - begun == dut.waiting);
        if (dut.waiting && begun == chosen_line) begin
            assert (dut.operands == its_operands);
            assert (dut.operands_user == its_user);
<%- if line.is_none() %>
            assert (dut.operands_last == its_last);
<%- endif %>
        end
<%- if let Some(line) = line %>
        if (dut.core.computing && begun - 2'd1 == chosen_line) assert (dut.user == its_user);
        // The buffer has room for all points of the line that are still to come.
        assert (dut.next_line - dut.write_at == dut.core.to_come);
        assert (stored <= reserved);
        assert (reserved <= ${ line.places() }$);
        // The points leave the buffer in order.
        assert (given + m_axis_tvalid == dut.read_at);
        if (watched_from_read < stored) assert (dut.buffer.watched_word == its_results);
        if (m_axis_tvalid && its_turn) begin
            assert ({m_axis_tuser, m_axis_tlast, m_axis_tdata} == its_turn_results);
        end
<%- else %>
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
<%- endif %>
    end
endmodule

`default_nettype wire
