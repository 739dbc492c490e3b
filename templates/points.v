// ${ list.name }$: runs ${ list.module }$ on the points of a file
//
// Each line of POINTS_FILE holds the operands of one computation in hexadecimal, in port order. For
// each result, the module writes a line to RESULTS_FILE with the outputs in hexadecimal, in port
// order. After the last result of a computation it writes a line with a single dot. Inputs change
// on the falling edge of the clock. Outputs are read just before the rising edge.

`default_nettype none

module ${ list.name }$ #(
    parameter POINTS_FILE  = "${ list.points_file }$",
    parameter RESULTS_FILE = "${ list.results_file }$"
);
    localparam LIMIT = ${ list.limit }$;  // the most clocks of one computation

    reg clk = 1'b0;
<%- for line in list.declarations %>
${ line }$
<%- endfor %>

    integer ${ names.points }$;
    integer ${ names.results }$;
    integer ${ names.read }$;
    integer ${ names.clocks }$;
    integer ${ names.total }$ = 0;

    ${ list.module }$ ${ names.dut }$ (
<%- for line in list.connections %>
        ${ line }$
<%- endfor %>
    );

    task ${ names.tick }$;
        begin
            #5 clk = 1'b1;
            #5 clk = 1'b0;
        end
    endtask

    initial begin
        ${ names.points }$ = $fopen(POINTS_FILE, "r");
        ${ names.results }$ = $fopen(RESULTS_FILE, "w");
        ${ list.reset }$ = 1'b0;
        ${ start }$ = 1'b0;
<%- for strobe in strobes %>
        ${ strobe }$ = 1'b0;
<%- endfor %>
        ${ names.tick }$;
        ${ list.reset }$ = 1'b1;
        ${ names.read }$ = $fscanf(
            ${ names.points }$, "${ list.scan }$"
<%- for operand in list.operands %>,
            ${ operand }$
<%- endfor %>
        );
        while (${ names.read }$ == ${ list.operands.len() }$) begin
            // The operand registers load in the same clock in which `start` is high.
            ${ start }$ = 1'b1;
<%- for strobe in strobes %>
            ${ strobe }$ = 1'b1;
<%- endfor %>
            ${ names.tick }$;
            ${ start }$ = 1'b0;
<%- for strobe in strobes %>
            ${ strobe }$ = 1'b0;
<%- endfor %>
            ${ names.clocks }$ = 0;
            while (${ busy }$ && ${ names.clocks }$ < LIMIT) begin
                if (${ list.valid }$) begin
                    $fwrite(
                        ${ names.results }$, "${ list.print }$\n"
<%- for result in list.results %>,
                        ${ result }$
<%- endfor %>
                    );
                end
                ${ names.tick }$;
                ${ names.clocks }$ = ${ names.clocks }$ + 1;
            end
            if (${ busy }$) begin
                $display("FAIL ${ list.module }$: computation %0d does not end", ${ names.total }$);
                $fatal;
            end
            $fwrite(${ names.results }$, ".\n");
            ${ names.total }$ = ${ names.total }$ + 1;
            ${ names.read }$ = $fscanf(
                ${ names.points }$, "${ list.scan }$"
<%- for operand in list.operands %>,
                ${ operand }$
<%- endfor %>
            );
        end
        $fclose(${ names.results }$);
        $display("PASS ${ list.module }$: %0d computations", ${ names.total }$);
        $finish;
    end
endmodule

`default_nettype wire
