// ${ name }$: properties of the handshake of ${ module }$
//
// For formal tools only. All inputs are arbitrary. To prove the properties, run in a directory with
// the files of both folders:
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

    // The reset is active in the first clock. The state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);
<%- if let Some(load) = table_load %>

    // The table loads a word only while no computation runs.
    (* hierconn *) wire ${ load }$;
    always @* if (!$initstate) begin
        assert (table_ready == !busy);
        if (busy) assert (!${ load }$);
        if (table_write && table_ready) assert (${ load }$);
    end
<%- endif %>
<%- if let Some(age) = age %>

    // The number of clocks since start.
    reg ${ age.range }$ ${ age.name }$;
    always @(posedge clk) ${ age.name }$ <= <% if overlaps %>busy && !done<% else %>busy<% endif %> ? ${ age.name }$ + ${ age.one }$ : ${ age.one }$;
<%- endif %>
<%- if let Some(bounded) = bounded %>

    // The address of the current microinstruction, and the counters of loops.
<%- for line in bounded.inside %>
    ${ line }$
<%- endfor %>
<%- endif %>

    always @(posedge clk) if (!$initstate) begin
        if (!$past(rst_n)) begin
            // After a reset the core is idle, whatever the state before it was.
            assert (!busy && !done);
<%- if straight %>
<%- if overlaps %>
        end else if (!$past(busy && !done)) begin
            // The core is idle until start and busy from the clock after it. It accepts start in
            // the clock of done too.
<%- else %>
        end else if (!$past(busy)) begin
            // The core is idle until start and busy from the clock after it.
<%- endif %>
            assert (busy == $past(start));
        end else begin
            // The core is busy up to the clock of done.
            assert (busy == !$past(done));
<%- endif %>
        end
        if (done) assert (busy);
        if (valid) assert (busy);
<%- if let Some(age) = age %>
<%- if let Some(exact) = exact %>
        if ($past(rst_n)) begin
            // valid and done are high exactly in the clocks that the manifest promises.
            assert (valid == (busy && ${ age.name }$ == ${ exact.valid }$));
            assert (done == (busy && ${ age.name }$ == ${ exact.done }$));
            if (busy) assert (${ age.name }$ <= ${ exact.last }$);
        end
<%- endif %>
<%- if let Some(bounded) = bounded %>
        if (busy) begin
            // Every computation ends in time: the clocks so far, plus the most clocks from the
            // current microinstruction to the end, are within the promised number.
            assert (${ age.name }$ <= ${ bounded.most }$);
            case (${ bounded.address }$)
<%- for latest in bounded.latest %>
                ${ latest.label }$: assert (${ latest.end }$ <= ${ bounded.most }$);
<%- endfor %>
            endcase
        end
<%- if bounded.ends_with_result %>
        // Every computation ends with a result.
        if (done) assert (valid);
<%- endif %>
<%- if let Some(first) = bounded.first %>
        // From the clock that the manifest promises to the end, every clock has a result.
        assert (valid == (busy && ${ age.name }$ >= ${ first }$));
<%- endif %>
<%- endif %>
<%- endif %>
    end
endmodule

`default_nettype wire
