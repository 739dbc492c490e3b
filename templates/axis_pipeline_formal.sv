// ${ name }$_axis_formal: formal properties of ${ name }$_axis
//
// For formal tools only. All inputs are arbitrary, also those from the sender. A stub with the
// handshake of the core replaces the core: points leave its ${ stages }$ stages in the order in which
// they came, with arbitrary results. The core has this handshake by the proof of
//   ${ name }$_formal.sv
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
    (* anyseq *) reg [${ raw_high }$:0] any;
    reg [${ stages - 1 }$:0] points;  // the stages that hold a point; the first stage is bit 0
    reg [${ raw_high }$:0] shown;
    assign out_valid = points[${ stages - 1 }$];
<%- if interval > 1 %>
    wire moves = out_ready | ~out_valid;
    reg [${ slot_high }$:0] turn;  // the core accepts points at 0
    assign in_ready = moves & (turn == 0);
    always @(posedge clk) begin
        if (!rst_n) turn <= 0;
        else if (moves) turn <= (turn == ${ interval - 1 }$) ? 0 : turn + 1;
        if (!rst_n) points <= 0;
        else if (moves) points <= {points, in_valid & (turn == 0)};
        if (moves) shown <= any;
    end
<%- else %>
    assign in_ready = out_ready | ~out_valid;
    always @(posedge clk) begin
        if (!rst_n) points <= 0;
        else if (in_ready) points <= {points, in_valid};
        if (in_ready) shown <= any;
    end
<%- endif %>
<%- for result in raw %>
    assign ${ result.name }$ = shown[${ result.low + result.width - 1 }$:${ result.low }$];
<%- endfor %>
endmodule

<%- if memory.is_some() %>

// Registers replace the memory of the delay line of tlast and tuser.
module ${ name }$_delay #(
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
<%- endif %>

module ${ name }$_axis_formal (
    input wire aclk,
    input wire aresetn,
    input wire [${ in_high }$:0] s_axis_tdata,
<%- if keep %>
    input wire [${ in_high / 8 }$:0] s_axis_tkeep,
<%- endif %>
    input wire [${ user_bits - 1 }$:0] s_axis_tuser,
    input wire s_axis_tlast,
    input wire s_axis_tvalid,
    input wire m_axis_tready
);
    wire s_axis_tready;
    wire [${ out_high }$:0] m_axis_tdata;
<%- if keep %>
    wire [${ out_high / 8 }$:0] m_axis_tkeep;
<%- endif %>
    wire [${ user_bits - 1 }$:0] m_axis_tuser;
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
        .s_axis_tlast(s_axis_tlast),
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

    wire give = m_axis_tvalid && m_axis_tready;
    wire leaves = dut.core.out_valid && dut.core.out_ready;

    // Follows one arbitrary point through the stages.
    (* anyseq *) reg marks;
    reg was_marked;
    wire marked = marks && !was_marked && s_axis_tvalid && s_axis_tready;
    reg [${ stages - 1 }$:0] mark;
    reg [${ user_bits }$:0] its_side;
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
    reg [${ user_bits }$:0] its_last_side;
    reg [${ out_high }$:0] its_results;
    wire [${ out_high }$:0] results = {
<%- for line in packed %>
        ${ line }$
<%- endfor %>
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
<%- for check in checks %>
        assert (${ check }$);
<%- endfor %>
        // tuser and tlast advance with their point.
        if (mark[${ stages - 1 }$]) assert (dut.core.out_valid && dut.results_side == its_side);
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
<%- for stage in sides %>
        if (mark[${ loop.index0 }$]) assert (dut.${ side }$[${ stage.high }$:${ stage.low }$] == its_side);
<%- endfor %>
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
