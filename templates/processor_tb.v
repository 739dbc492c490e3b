// ${ top }$_tb: self-checking bench of ${ top }$
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s ${ top }$_tb -o sim ${ name }$*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top ${ top }$_tb ${ name }$*.v
//   $ obj_dir/V${ top }$_tb
// The bench executes an instruction for each result of points of the core's bench, and compares the
// answers. Inputs change on the falling edge of the clock. Outputs are read just before the rising
// edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module ${ top }$_tb #(
    parameter SENT_FILE     = "${ name }$_sent.mem",
    parameter RECEIVED_FILE = "${ name }$_received.mem"
);
    localparam POINTS   = ${ points }$;
    localparam EVERY    = ${ every }$;  // the bench computes one point in so many
    localparam RESULTS  = ${ results.len() }$;
    localparam LIMIT    = ${ limit }$;  // the most clocks until an answer
    localparam REPORTED = 20;  // the number of differences to print

    reg [${ in_high }$:0] sent [0:POINTS-1];
    reg [${ out_high }$:0] received [0:POINTS-1];
    reg [${ in_high }$:0] point;
    reg [${ out_high }$:0] result;

    // The initial values are set here: ${ name }$_tb.v says why.
    reg clk = 1'b0;
    reg reset = 1'b1;
    reg [31:0] random = 32'd1;
    reg [9:0] asked = 10'd0;
    reg [31:0] want;
    reg [31:0] got;
    reg known;
    reg answered;
    integer number = 0;
    integer place = 0;
    integer waited = 0;
    integer errors = 0;
    integer instructions = 0;
    always #5 clk = ~clk;

    task check(input right, input string what);
        if (right !== 1'b1) begin
            if (errors < REPORTED) $display("point %0d, function id %0d: %0s", number, asked, what);
            errors = errors + 1;
        end
    endtask

    task verdict;
        begin
            if (errors != 0) begin
                $display("FAIL ${ top }$: %0d differences", errors);
                $fatal;
            end
            $display("PASS ${ top }$: %0d instructions, no difference", instructions);
            $finish;
        end
    endtask

    // Waits until just before the next rising edge of the clock, when outputs can be read.
    task wait_a_clock;
        begin
            waited = waited + 1;
            if (waited > LIMIT) begin
                check(1'b0, "no answer");
                verdict;
            end
            #4;
        end
    endtask

    // The source registers.
    reg [31:0] word_0;
    reg [31:0] word_1;
<% include "processor_access.v" %>

    function is_known(input [9:0] asked);
        case (asked)
<%- for line in ids %>
            ${ line }$<% if loop.last %>: is_known = 1'b1;<% endif %>
<%- endfor %>
            default: is_known = 1'b0;
        endcase
    endfunction

    function [31:0] result_word(input integer number);
        case (number)
<%- for word in results %>
            ${ loop.index0 }$: result_word = ${ word }$;
<%- endfor %>
            default: result_word = 32'd0;
        endcase
    endfunction

    task compute;
        begin
            random = {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
            waited = 0;
            answered = 1'b0;
            known = is_known(asked);
            // The bits beside the operands may have any value.
            word_0 = ${ words[0] }$;
            word_1 = ${ words[1] }$;
            want = known ? result_word(place) : 32'd0;
            execute;
            if (known && got !== want && errors < REPORTED) $display("%h, not %h", got, want);
            instructions = instructions + 1;
        end
    endtask

    initial begin
        $readmemh(SENT_FILE, sent);
        $readmemh(RECEIVED_FILE, received);
        repeat (3) @(negedge clk);
        reset = 1'b0;
        while (number < POINTS) begin
            point = sent[number];
            result = received[number];
            // One instruction more than there are results: the core has none with this function id.
            for (place = 0; place <= RESULTS; place = place + 1) begin
                asked = {place[5:0], <% if opcode.is_empty() %>4'd0<% else %>${ opcode }$<% endif %>};
                compute;
            end
            number = number + EVERY;
        end
        verdict;
    end
endmodule

`default_nettype wire
