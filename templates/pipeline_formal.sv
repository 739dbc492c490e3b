// ${ name }$: formal properties of the handshake of ${ module }$
//
// For formal tools only. All inputs are arbitrary. To prove the properties, run in a directory with
// the files of both folders:
//   $ yosys -q ${ name }$.ys
//   $ yosys-smtbmc --unroll -s z3 -t ${ depth }$ ${ name }$.smt2
//   $ yosys-smtbmc --unroll -s z3 -i -t ${ depth }$ ${ name }$.smt2
// or, with SymbiYosys,
//   $ sby -f ${ name }$.sby
//
// Generated files belong to their user, without conditions.

`default_nettype none

module ${ name }$ (
<%- for line in ports %>
    ${ line }$
<%- endfor %>
);
<%- for line in outputs %>
${ line }$
<%- endfor %>

    ${ module }$ ${ instance }$ (
<%- for line in connections %>
        ${ line }$
<%- endfor %>
    );

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    // The stages that hold a point.
<%- for line in inside %>
    ${ line }$
<%- endfor %>
    wire [${ stages }$:1] ${ present }$ = ${ valid }$;

    // A reference model of these bits. All points advance together, unless a result waits.
    wire ${ moves }$ = ${ moves_when }$;
<%- if let Some(turn) = turn %>
    reg  ${ turn.range }$${ turn.name }$;  // the core accepts points at 0
    always @(posedge clk) begin
        if (!rst_n) ${ turn.name }$ <= 0;
        else if (${ moves }$) ${ turn.name }$ <= ${ turn.next }$;
    end
<%- endif %>
    reg  [${ stages }$:1] ${ queue }$;
    always @(posedge clk) begin
        if (!rst_n) ${ queue }$ <= ${ empty }$;
        else if (${ moves }$) ${ queue }$ <= ${ queue_next }$;
    end
<%- if let Some(load) = table_load %>

    // The table loads a word only while no point is in the pipeline or offered.
    always @* if (!$initstate) begin
        assert (table_ready == !(in_valid || ${ present }$ != ${ empty }$));
        assert (${ load }$ == (table_write && table_ready));
    end
<%- endif %>
<%- if let Some(side) = side %>

    // Follows one arbitrary point, which the free input ${ chosen }$ chooses: its stage and its
    // side bits.
    wire ${ begins }$ = ${ offered }$ & ${ moves }$ & ${ chosen }$ & ~|${ followed }$;
    reg  [${ stages }$:1] ${ followed }$;
    reg  ${ side.range }$ ${ side.tag }$;
    always @(posedge clk) begin
        if (!rst_n) ${ followed }$ <= ${ empty }$;
        else if (${ moves }$) ${ followed }$ <= ${ followed_next }$;
        if (${ begins }$) ${ side.tag }$ <= side_in;
    end
<%- endif %>

    always @(posedge clk) if (!$initstate) begin
        // No point is lost or duplicated, and every point takes the same number of moves: out_valid
        // equals that of the reference model, whatever out_ready does.
        assert (${ present }$ == ${ queue }$);
        assert (out_valid == ${ queue }$[${ stages }$]);
<%- if let Some(turn) = turn %>
        // The core accepts a point in slot 0 whenever no result waits.
        assert (${ turn.slot }$ == ${ turn.name }$);
        assert (in_ready == (${ moves }$ & (${ turn.name }$ == 0)));
<%- else if stall %>
        // The core accepts a point whenever no result waits.
        assert (in_ready == ${ moves }$);
<%- endif %>
<%- if stall %>
        // A waiting result stays unchanged.
        if ($past(rst_n && out_valid && !out_ready)) begin
            assert (out_valid);
<%- for result in results %>
            assert ($stable(${ result }$));
<%- endfor %>
        end
<%- endif %>
<%- if let Some(side) = side %>
        // The side bits of a point come out with that point, so no point overtakes another.
        assert ((${ followed }$ & ~${ queue }$) == ${ empty }$);
<%- for stage in side.stages %>
        if (${ followed }$[${ stage.number }$]) assert (${ stage.value }$ == ${ side.tag }$);
<%- endfor %>
        if (${ followed }$[${ stages }$]) assert (side_out == ${ side.tag }$);
<%- endif %>
    end
endmodule

`default_nettype wire
