// ${ name }$: computes with ${ module }$ what a file lists
//
// Every line of POINTS_FILE has the operands of one point in hexadecimal, in port order. ${ name }$
// offers a point every clock, and writes a line for each to RESULTS_FILE, with the outputs in
// hexadecimal, in port order, and a line with a single dot behind it.
// Inputs change on the falling edge of the clock; outputs are read just before the rising edge.

`default_nettype none

module ${ name }$ #(
    parameter POINTS_FILE  = "${ points_file }$",
    parameter RESULTS_FILE = "${ results_file }$"
);
    localparam LIMIT = ${ limit }$;  // clocks from the last point to the last results

    reg clk = 1'b0;
<%- for line in declarations %>
${ line }$
<%- endfor %>

    integer ${ names.points }$;
    integer ${ names.results }$;
    integer ${ names.read }$;
    integer ${ names.clocks }$ = 0;
    integer ${ names.offered }$ = 0;
    integer ${ names.total }$ = 0;

    ${ module }$ ${ names.dut }$ (
<%- for line in connections %>
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
        ${ reset }$ = 1'b0;
        ${ in_valid }$ = 1'b0;
<%- for (name, value) in held %>
        ${ name }$ = ${ value }$;
<%- endfor %>
        ${ names.tick }$;
        ${ reset }$ = 1'b1;
        ${ names.read }$ = ${ operands.len() }$;
        while (${ names.clocks }$ < LIMIT && (${ names.read }$ == ${ operands.len() }$ || ${ names.total }$ < ${ names.offered }$)) begin
            if (${ names.read }$ == ${ operands.len() }$)
                ${ names.read }$ = $fscanf(
                    ${ names.points }$, "${ scan }$"
<%- for operand in operands %>,
                    ${ operand }$
<%- endfor %>
                );
            ${ in_valid }$ = ${ names.read }$ == ${ operands.len() }$;
            if (${ in_valid }$) ${ names.offered }$ = ${ names.offered }$ + 1;
            else ${ names.clocks }$ = ${ names.clocks }$ + 1;
            if (${ valid }$) begin
                $fwrite(
                    ${ names.results }$, "${ print }$\n.\n"
<%- for result in results %>,
                    ${ result }$
<%- endfor %>
                );
                ${ names.total }$ = ${ names.total }$ + 1;
            end
            ${ names.tick }$;
        end
        if (${ names.total }$ < ${ names.offered }$) begin
            $display("FAIL ${ module }$: %0d points, %0d results", ${ names.offered }$, ${ names.total }$);
            $fatal;
        end
        $fclose(${ names.results }$);
        $display("PASS ${ module }$: %0d computations", ${ names.total }$);
        $finish;
    end
endmodule

`default_nettype wire
