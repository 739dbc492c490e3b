// ${ name }$_axis_formal: what is proved of ${ name }$_axis
//
// For formal tools alone. All inputs are free, the sender's too. The core is abstracted to its
// handshake and its ${ last }$ stages: a point has any results. To prove it, from a directory that
// holds the files of both folders:
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
<%- for stage in stages %>
    reg valid_${ stage.number }$;
    reg [${ raw_high }$:0] data_${ stage.number }$;
<%- endfor %>
    assign in_ready = out_ready | ~valid_${ last }$;
    assign out_valid = valid_${ last }$;
    always @(posedge clk) begin
        if (!rst_n) begin
<%- for stage in stages %>
            valid_${ stage.number }$ <= 1'b0;
<%- endfor %>
        end else if (in_ready) begin
            valid_1 <= in_valid;
<%- for stage in stages %>
<%- if stage.number > 1 %>
            valid_${ stage.number }$ <= valid_${ stage.number - 1 }$;
<%- endif %>
<%- endfor %>
        end
        if (in_ready) begin
            data_1 <= any;
<%- for stage in stages %>
<%- if stage.number > 1 %>
            data_${ stage.number }$ <= data_${ stage.number - 1 }$;
<%- endif %>
<%- endfor %>
        end
    end
<%- for result in raw %>
    assign ${ result.name }$ = data_${ last }$[${ result.low + result.width - 1 }$:${ result.low }$];
<%- endfor %>
endmodule

module ${ name }$_axis_formal (
    input wire aclk,
    input wire aresetn,
    input wire [${ in_high }$:0] s_axis_tdata,
    input wire [${ user_bits - 1 }$:0] s_axis_tuser,
    input wire s_axis_tlast,
    input wire s_axis_tvalid,
    input wire m_axis_tready
);
    wire s_axis_tready;
    wire [${ out_high }$:0] m_axis_tdata;
    wire [${ user_bits - 1 }$:0] m_axis_tuser;
    wire m_axis_tlast;
    wire m_axis_tvalid;

    ${ name }$_axis dut (
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
<%- for wire in inside %>
    ${ wire }$
<%- endfor %>

    // The reset comes first; the state before it is arbitrary.
    always @* if ($initstate) assume (!aresetn);

    // Points taken and given, modulo more than there can be under way.
    localparam COUNT = ${ count_bits }$;
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
    reg [${ user_bits }$:0] its_side;
    reg [${ raw_high }$:0] its_raw;
    always @(posedge aclk) begin
        if (accept && taken == chosen) begin
            its_side <= {s_axis_tlast, s_axis_tuser};
            its_raw <= dut.core.any;
        end
    end
<%- for result in raw %>
    wire ${ result.range }$ its_${ result.name }$ = its_raw[${ result.low + result.width - 1 }$:${ result.low }$];
<%- endfor %>
    wire [${ out_high }$:0] its_results = {
<%- for line in packed %>
        ${ line }$
<%- endfor %>
    };

    // The numbers of the points, which travel with them, and the one that is next in each place.
    reg [COUNT-1:0] offered_number;
    reg [COUNT-1:0] held_number;
    wire [COUNT-1:0] next_held = given + m_axis_tvalid;
    wire [COUNT-1:0] next_${ last }$ = dut.held ? held_number + 1'd1 : next_held;
<%- for stage in stages %>
    reg [COUNT-1:0] number_${ stage.number }$;
    wire [COUNT-1:0] next_${ stage.number - 1 }$ = dut.core.valid_${ stage.number }$ ? number_${ stage.number }$ + 1'd1 : next_${ stage.number }$;
<%- endfor %>
    always @(posedge aclk) begin
        if (m_axis_tready || !m_axis_tvalid) offered_number <= dut.held ? held_number : number_${ last }$;
        if (!dut.held) held_number <= number_${ last }$;
        if (s_axis_tready) begin
            number_1 <= taken;
<%- for stage in stages %>
<%- if stage.number > 1 %>
            number_${ stage.number }$ <= number_${ stage.number - 1 }$;
<%- endif %>
<%- endfor %>
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
            if ($past(dut.core.valid_${ last }$ && !dut.held)) assert (m_axis_tvalid);
            if ($past(m_axis_tready)) assert (s_axis_tready);
        end else begin
            assert (!m_axis_tvalid);
        end
        // The core computes with what is sent.
<%- for check in checks %>
        assert (${ check }$);
<%- endfor %>
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
<%- for stage in stages %>
        if (dut.core.valid_${ stage.number }$) assert (number_${ stage.number }$ == next_${ stage.number }$);
        if (dut.core.valid_${ stage.number }$ && number_${ stage.number }$ == chosen) begin
            assert (dut.core.data_${ stage.number }$ == its_raw);
            assert (dut.side[${ stage.side_high }$:${ stage.side_low }$] == its_side);
        end
<%- endfor %>
    end
endmodule

`default_nettype wire
