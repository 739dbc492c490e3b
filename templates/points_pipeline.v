// ${ list.name }$: runs ${ list.module }$ on the points of a file
//
// Each line of POINTS_FILE holds the operands of one point in hexadecimal, in port order. The
// module offers a point ${ every }$. For each point it writes two lines to RESULTS_FILE: the
// outputs in hexadecimal, in port order, and a single dot. Inputs change on the falling edge of the
// clock. Outputs are read just before the rising edge.

`default_nettype none

module ${ list.name }$ #(
    parameter POINTS_FILE  = "${ list.points_file }$",
    parameter RESULTS_FILE = "${ list.results_file }$"
);
    localparam LIMIT = ${ list.limit }$;  // the most clocks from the last point to its results

    reg clk = 1'b0;
<%- for line in list.declarations %>
${ line }$
<%- endfor %>

    integer ${ names.points }$;
    integer ${ names.results }$;
    integer ${ names.read }$;
    integer ${ names.clocks }$ = 0;
    integer ${ names.offered }$ = 0;
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
        ${ in_valid }$ = 1'b0;
<%- for (name, value) in held %>
        ${ name }$ = ${ value }$;
<%- endfor %>
        ${ names.tick }$;
        ${ list.reset }$ = 1'b1;
        ${ names.read }$ = ${ list.operands.len() }$;
        while (${ names.clocks }$ < LIMIT && (${ names.read }$ == ${ list.operands.len() }$ || ${ names.total }$ < ${ names.offered }$)) begin
            if (${ names.read }$ == ${ list.operands.len() }$${ taken }$)
                ${ names.read }$ = $fscanf(
                    ${ names.points }$, "${ list.scan }$"
<%- for operand in list.operands %>,
                    ${ operand }$
<%- endfor %>
                );
            ${ in_valid }$ = ${ names.read }$ == ${ list.operands.len() }$${ taken }$;
            if (${ in_valid }$) ${ names.offered }$ = ${ names.offered }$ + 1;
            else ${ waits }$${ names.clocks }$ = ${ names.clocks }$ + 1;
            if (${ list.valid }$) begin
                $fwrite(
                    ${ names.results }$, "${ list.print }$\n.\n"
<%- for result in list.results %>,
                    ${ result }$
<%- endfor %>
                );
                ${ names.total }$ = ${ names.total }$ + 1;
            end
            ${ names.tick }$;
        end
        if (${ names.total }$ < ${ names.offered }$) begin
            $display("FAIL ${ list.module }$: %0d points, %0d results", ${ names.offered }$, ${ names.total }$);
            $fatal;
        end
        $fclose(${ names.results }$);
        $display("PASS ${ list.module }$: %0d computations", ${ names.total }$);
        $finish;
    end
endmodule

`default_nettype wire
