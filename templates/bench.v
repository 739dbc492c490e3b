// ${ name }$: self-checking bench of ${ module }$
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s ${ name }$ -o sim ${ module }$*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top ${ name }$ ${ module }$*.v
//   $ obj_dir/V${ name }$
// Inputs change on the falling edge of the clock. The bench compares outputs just before the rising
// edge.
<%- if word_stride > 1 %>
// To keep the bench short, its points cover only one in ${ word_stride }$ words of the memories: a
// wrong bit in another word may go unnoticed.
<%- endif %>
//
// Generated files belong to their user, without conditions.

`default_nettype none

module ${ name }$ #(
    parameter STIMULUS_FILE = "${ stimulus_file }$",
    parameter EXPECTED_FILE = "${ expected_file }$"
);
    localparam CLOCKS     = ${ clocks }$;
    localparam KNOWN_FROM = ${ known_from }$;  // the first clock in which results are compared
    localparam REPORTED   = 20;  // the number of differences to print

    reg [${ stimulus_last }$:0] ${ names.stimulus }$ [0:CLOCKS-1];
    reg [${ expected_last }$:0] ${ names.expected }$ [0:CLOCKS-1];
    reg [${ expected_last }$:0] ${ names.want }$;

    reg clk = 1'b0;
<%- for line in declarations %>
${ line }$
<%- endfor %>

    integer ${ names.clock }$;
    // The initial values are set here and not in the process below, because Verilator 5.006 treats
    // a variable as constant after a loop with delays if the process has set it before the loop.
    integer ${ names.errors }$ = 0;
    reg ${ names.was_reset }$ = ${ reset_seen }$;  // the control unit is in a known state

    ${ module }$ ${ names.dut }$ (
<%- for line in connections %>
        ${ line }$
<%- endfor %>
    );
<%- if let Some(address) = address %>

    // Prints the address and the name of the current microinstruction.
    task ${ names.write_microinstruction }$;
        begin
            $write("microinstruction ");
            case (${ address }$)
<%- for it in microprogram %>
                ${ it.label }$: $write("${ it.address }$ (${ it.name }$)");
<%- endfor %>
                default: $write("unknown");
            endcase
        end
    endtask
<%- endif %>

    initial begin
        $readmemh(STIMULUS_FILE, ${ names.stimulus }$);
        $readmemh(EXPECTED_FILE, ${ names.expected }$);
        for (${ names.clock }$ = 0; ${ names.clock }$ < CLOCKS; ${ names.clock }$ = ${ names.clock }$ + 1) begin
<%- for line in stimulus %>
${ line }$
<%- endfor %>
            ${ names.want }$ = ${ names.expected }$[${ names.clock }$];
            #4;
            if (${ names.was_reset }$) begin
<%- for output in handshake %>
<% include "compare.v" %>
<%- endfor %>
            end
            if (${ names.clock }$ >= KNOWN_FROM<% if let Some(shown) = shown %> && ${ shown }$<% endif %>) begin
<%- for output in results %>
<% include "compare.v" %>
<%- endfor %>
            end
<%- if let Some(reset) = reset %>
            if (!${ reset }$) ${ names.was_reset }$ = 1'b1;
<%- endif %>
            #1 clk = 1'b1;
            #5 clk = 1'b0;
        end
        if (${ names.errors }$ != 0) begin
            $display("FAIL ${ module }$: %0d differences in %0d clocks", ${ names.errors }$, CLOCKS);
            $fatal;
        end
        $display("PASS ${ module }$: %0d clocks, no difference", CLOCKS);
        $finish;
    end
endmodule

`default_nettype wire
