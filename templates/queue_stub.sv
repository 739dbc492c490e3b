module ${ stub.core }$ (
<%- for line in stub.ports %>
    ${ line }$
<%- endfor %>
);
    (* anyseq *) reg ends;
    (* anyseq *) reg offers;
<%- for line in stub.free %>
    ${ line }$
<%- endfor %>
    // The number of points that were started and whose results nobody has taken.
    reg ${ queue.count }$ claimed;
    reg ${ queue.count }$ results_waiting;
    reg ended;
    assign waiting = results_waiting;
    assign busy = claimed != results_waiting;
    assign full = claimed == ${ queue.depth }$;
    assign offering = offers;
    assign valid = done;
    assign done = ended;
    wire arrives = busy && ends;
    always @(posedge clk) begin
        ended <= rst_n && arrives;
        claimed <= rst_n ? claimed + start - take : 0;
        results_waiting <= rst_n ? results_waiting + arrives - take : 0;
    end

    always @* if (!$initstate) begin
        assert (results_waiting <= claimed && claimed <= ${ queue.depth }$);
        // Only a result that waits is taken.
        if (take) assert (results_waiting != 0);
    end
    // A computation starts only if there is room for its results, and loads all operands.
    always @* if (!$initstate && start) begin
        assert (claimed < ${ queue.depth }$);
<%- for strobe in stub.strobes %>
        assert (${ strobe }$);
<%- endfor %>
    end
endmodule
