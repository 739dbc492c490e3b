// ${ name }$: properties of the handshake of ${ module }$
//
// For formal tools alone: every input is free. To prove it, from a directory that holds the files
// of both folders:
//   $ yosys -q ${ name }$.ys
//   $ yosys-smtbmc ${ solver }$ -t ${ depth }$ ${ name }$.smt2
//   $ yosys-smtbmc ${ solver }$ -i -t ${ depth }$ ${ name }$.smt2
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
<%- if let Some(age) = age %>

    // Clocks since start.
    reg ${ age.range }$ ${ age.name }$;
    always @(posedge clk) ${ age.name }$ <= <% if overlaps %>busy && !done<% else %>busy<% endif %> ? ${ age.name }$ + ${ age.one }$ : ${ age.one }$;
<%- endif %>
<%- if let Some(bounded) = bounded %>

    // The microinstruction that is executed, and the counters of loops.
<%- for line in bounded.inside %>
    ${ line }$
<%- endfor %>
<%- endif %>

    always @(posedge clk) if (!$initstate) begin
        if (!$past(rst_n)) begin
            // Idle after reset, whatever the state was before.
            assert (!busy && !done);
<%- if straight %>
<%- if overlaps %>
        end else if (!$past(busy && !done)) begin
            // Idle until start, which is heard in the clock of done too, and busy from the clock
            // after it.
<%- else %>
        end else if (!$past(busy)) begin
            // Idle until start, busy from the clock after it.
<%- endif %>
            assert (busy == $past(start));
        end else begin
            // Busy up to the clock of done.
            assert (busy == !$past(done));
<%- endif %>
        end
        if (done) assert (busy);
        if (valid) assert (busy);
<%- if let Some(age) = age %>
<%- if let Some(exact) = exact %>
        if ($past(rst_n)) begin
            // The clocks that the manifest promises.
            assert (valid == (busy && ${ age.name }$ == ${ exact.valid }$));
            assert (done == (busy && ${ age.name }$ == ${ exact.done }$));
            if (busy) assert (${ age.name }$ <= ${ exact.last }$);
        end
<%- endif %>
<%- if let Some(bounded) = bounded %>
        if (busy) begin
            // Every computation ends in time: its clocks so far, and the most that can follow.
            assert (${ age.name }$ <= ${ bounded.most }$);
            case (${ bounded.address }$)
<%- for latest in bounded.latest %>
                ${ latest.label }$: assert (${ latest.end }$ <= ${ bounded.most }$);
<%- endfor %>
            endcase
        end
<%- if bounded.ends_with_result %>
        // No computation ends without a result.
        if (done) assert (valid);
<%- endif %>
<%- if let Some(first) = bounded.first %>
        // From the clock that the manifest promises a result a clock, to the end.
        assert (valid == (busy && ${ age.name }$ >= ${ first }$));
<%- endif %>
<%- endif %>
<%- endif %>
    end
endmodule

`default_nettype wire
