// ${ name }$: what is proved of the handshake of ${ module }$
//
// For formal tools alone: every input is free. To prove it, from a directory that holds the files
// of both folders:
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

    // The reset comes first; the state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    // Which stage of the pipeline has a point.
<%- for line in inside %>
    ${ line }$
<%- endfor %>
    wire [${ stages }$:1] ${ present }$ = ${ valid }$;

    // The same for a queue beside it: all points in it move together, unless a result waits.
    wire ${ moves }$ = ${ moves_when }$;
<%- if let Some(turn) = turn %>
    reg  ${ turn.range }$${ turn.name }$;  // points are taken at 0
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
<%- if let Some(side) = side %>

    // One point, whichever it is: ${ chosen }$ is free. Where it is, and what travels with it.
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
        // No point is lost, none is doubled, and none comes sooner or later than the stages let it:
        // out_valid follows from the points that were taken, whatever out_ready is.
        assert (${ present }$ == ${ queue }$);
        assert (out_valid == ${ queue }$[${ stages }$]);
<%- if let Some(turn) = turn %>
        // A point is taken in its turn, whenever no result waits.
        assert (${ turn.slot }$ == ${ turn.name }$);
        assert (in_ready == (${ moves }$ & (${ turn.name }$ == 0)));
<%- else if stall %>
        // A point is taken whenever no result waits.
        assert (in_ready == ${ moves }$);
<%- endif %>
<%- if stall %>
        // A result that waits stays as it is.
        if ($past(rst_n && out_valid && !out_ready)) begin
            assert (out_valid);
<%- for result in results %>
            assert ($stable(${ result }$));
<%- endfor %>
        end
<%- endif %>
<%- if let Some(side) = side %>
        // What was offered with a point comes out with it: none overtakes another.
        assert ((${ followed }$ & ~${ queue }$) == ${ empty }$);
<%- for stage in side.stages %>
        if (${ followed }$[${ stage.number }$]) assert (${ stage.value }$ == ${ side.tag }$);
<%- endfor %>
        if (${ followed }$[${ stages }$]) assert (side_out == ${ side.tag }$);
<%- endif %>
    end
endmodule

`default_nettype wire
