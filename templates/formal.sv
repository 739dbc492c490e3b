// ${ name }$: what is proved of the handshake of ${ module }$
//
// For formal tools alone: every input is free. To prove it, from a directory that holds the files
// of both folders:
//   $ yosys -q ${ name }$.ys
//   $ yosys-smtbmc ${ solver }$ -t ${ depth }$ ${ name }$.smt2
//   $ yosys-smtbmc ${ solver }$ -i -t ${ depth }$ ${ name }$.smt2
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

    // The initial set comes first; the state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);
<%- if let Some(exact) = exact %>

    // Clocks since start.
    reg ${ age_range }$ ${ age }$;
    always @(posedge clk) ${ age }$ <= busy ? ${ age }$ + ${ age_one }$ : ${ age_one }$;
<%- endif %>

    always @(posedge clk) if (!$initstate) begin
        if (!$past(rst_n)) begin
            // Idle after the initial set, whatever was before.
            assert (!busy && !done);
<%- if straight %>
        end else if (!$past(busy)) begin
            // Idle until start, busy from the clock after it.
            assert (busy == $past(start));
        end else begin
            // Busy to the clock of done.
            assert (busy == !$past(done));
<%- endif %>
        end
        if (done) assert (busy);
<%- if let Some(exact) = exact %>
        if ($past(rst_n)) begin
            // The clocks that the manifest promises.
            assert (valid == (busy && ${ age }$ == ${ exact.valid }$));
            assert (done == (busy && ${ age }$ == ${ exact.done }$));
            if (busy) assert (${ age }$ <= ${ exact.last }$);
        end
<%- endif %>
    end
endmodule

`default_nettype wire
