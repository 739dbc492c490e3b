module ${ stub.core }$ (
<%- for line in stub.ports %>
    ${ line }$
<%- endfor %>
);
    (* anyseq *) reg ends;
<%- for line in stub.free %>
    ${ line }$
<%- endfor %>
    reg run;
    assign busy = run;
    assign valid = done;
    assign done = run & ends;
    always @(posedge clk) run <= rst_n & (run ? ~done : start);

    // A computation starts only after the computation before it has ended, and loads all operands.
    always @* if (!$initstate && start) begin
        assert (!run);
<%- for strobe in stub.strobes %>
        assert (${ strobe }$);
<%- endfor %>
    end
endmodule
