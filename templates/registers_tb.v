// ${ top }$_tb: self-checking bench of ${ top }$
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s ${ top }$_tb -o sim ${ name }$*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top ${ top }$_tb ${ name }$*.v
//   $ obj_dir/V${ top }$_tb
// The bench writes the operands of points of the core's bench, starts each computation in one of
// the possible ways in turn, and reads the results. Inputs change on the falling edge of the clock.
// Outputs are read just before the rising edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module ${ top }$_tb #(
    parameter SENT_FILE     = "${ name }$_sent.mem",
    parameter RECEIVED_FILE = "${ name }$_received.mem"
);
    localparam POINTS   = ${ points }$;
    localparam EVERY    = ${ every }$;  // the bench computes one point in so many
    localparam PARTS    = ${ parts.len() }$;  // the number of operand registers
    localparam RESULTS  = ${ results.len() }$;  // the number of result registers
    localparam WORDS    = ${ words }$;  // the number of registers
    localparam LIMIT    = ${ limit }$;  // the most clocks until an answer
    localparam REPORTED = 20;  // the number of differences to print
    localparam [31:0] STATUS = 32'h10, CONTROL = 32'h14, ENABLE = 32'h18, PENDING = 32'h1c;

    reg [${ in_high }$:0] sent [0:POINTS-1];
    reg [${ out_high }$:0] received [0:POINTS-1];
    reg [${ in_high }$:0] point;
    reg [${ out_high }$:0] result;

    // The initial values are set here: ${ name }$_tb.v says why.
    reg clk = 1'b0;
    reg reset = 1'b1;
    reg irq_enabled = 1'b0;
    reg answered;
    reg failed;
    reg [31:0] got;
    reg [31:0] random = 32'd1;
    integer number = 0;
    integer part = 0;
    integer waited = 0;
    integer errors = 0;
    integer accesses = 0;
<%- if queue.is_some() %>
    integer first;
    integer last;
<%- endif %>
    wire irq;
    always #5 clk = ~clk;

    // The access that `access` asks for.
    reg asked = 1'b0;
    reg asked_write;
    reg [31:0] asked_address;
    reg [31:0] asked_data;
    reg [3:0] asked_bytes;

    task check(input right, input string what);
        if (right !== 1'b1) begin
            if (errors < REPORTED) $display("point %0d, access %0d: %0s", number, accesses, what);
            errors = errors + 1;
        end
    endtask

    task verdict;
        begin
            if (errors != 0) begin
                $display("FAIL ${ top }$: %0d differences", errors);
                $fatal;
            end
            $display("PASS ${ top }$: %0d accesses, no difference", accesses);
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

    // Does one access to a register, and waits until it is done. The process below calls
    // `do_access`, so that a compiler that copies a task to each of its calls copies it once.
    task access(input [31:0] address, input writes, input [31:0] data, input [3:0] bytes);
        begin
            asked_address = address;
            asked_write = writes;
            asked_data = data;
            asked_bytes = bytes;
            asked = 1'b1;
            wait (!asked);
        end
    endtask

<%- if wishbone %>
<% include "wb_tb.v" %>
<%- else %>
<% include "axil_tb.v" %>
<%- endif %>

    // Does the accesses that `access` asks for.
    initial forever begin
        wait (asked);
        accesses = accesses + 1;
        random = {random[30:0], random[31] ^ random[21] ^ random[1] ^ random[0]};
        waited = 0;
        answered = 1'b0;
        do_access;
        asked = 1'b0;
    end

    function [31:0] part_at(input integer number);
        case (number)
<%- for part in parts %>
            ${ loop.index0 }$: part_at = ${ part.at }$;
<%- endfor %>
            default: part_at = 32'd0;
        endcase
    endfunction
    // part_word is the word that the bench writes, with arbitrary bits above the operand. part_mask
    // has the bits that read back.
    function [31:0] part_word(input integer number);
        case (number)
<%- for part in parts %>
            ${ loop.index0 }$: part_word = ${ part.word }$;
<%- endfor %>
            default: part_word = 32'd0;
        endcase
    endfunction
    function [31:0] part_mask(input integer number);
        case (number)
<%- for part in parts %>
            ${ loop.index0 }$: part_mask = ${ part.mask }$;
<%- endfor %>
            default: part_mask = 32'd0;
        endcase
    endfunction
    function [31:0] result_at(input integer number);
        case (number)
<%- for part in results %>
            ${ loop.index0 }$: result_at = ${ part.at }$;
<%- endfor %>
            default: result_at = 32'd0;
        endcase
    endfunction
    function [31:0] result_word(input integer number);
        case (number)
<%- for part in results %>
            ${ loop.index0 }$: result_word = ${ part.word }$;
<%- endfor %>
            default: result_word = 32'd0;
        endcase
    endfunction

    task write(input [31:0] address, input [31:0] data, input [3:0] bytes);
        begin
            access(address, 1'b1, data, bytes);
            check(!failed, "a write fails");
        end
    endtask

    task expect_word(input [31:0] address, input [31:0] word);
        begin
            access(address, 1'b0, 32'd0, 4'hf);
            check(!failed, "a read fails");
            if (got !== word && errors < REPORTED)
                $display("at %h: %h, not %h", address, got, word);
            check(got === word, "what is read");
        end
    endtask

    // A write must fail. A read must fail too if `reads` is 1, and must not if it is 0.
    task expect_error(input [31:0] address, input reads);
        begin
            access(address, 1'b1, 32'hffff_ffff, 4'hf);
            check(failed, "a write does not fail");
            access(address, 1'b0, 32'd0, 4'hf);
            check(failed == reads, "whether a read fails");
        end
    endtask

    task write_operands;
        for (part = 0; part < PARTS; part = part + 1) write(part_at(part), part_word(part), 4'hf);
    endtask

    // Writes each byte of a word alone, with wrong data in the bytes that are not enabled.
    task write_bytes;
        for (part = 0; part < PARTS; part = part + 1) begin
            write(part_at(part), part_word(part) ^ 32'hffff_ff00, 4'b0001);
            write(part_at(part), part_word(part) ^ 32'hff00_ffff, 4'b0100);
            write(part_at(part), part_word(part) ^ 32'h00ff_ffff, 4'b1000);
            write(part_at(part), part_word(part) ^ 32'hffff_00ff, 4'b0010);
        end
    endtask

    task expect_operands;
        for (part = 0; part < PARTS; part = part + 1) begin
            expect_word(part_at(part), part_word(part) & part_mask(part));
        end
    endtask

    task expect_results;
        for (part = 0; part < RESULTS; part = part + 1) begin
            expect_word(result_at(part), result_word(part));
        end
    endtask

    // Reads all registers and expects their values after a reset.
    task expect_reset;
        begin
            point = 0;
            result = 0;
<%- for (at, value) in constants %>
            expect_word(${ at }$, ${ value }$);
<%- endfor %>
            expect_operands;
            expect_results;
            check(!irq, "an interrupt");
        end
    endtask

    // Makes the register of the chosen part the start register, and writes it. Before that, it
    // checks that writes in which the byte of the start bit is not enabled start nothing.
    task start_by_write(input integer chosen);
        begin
            write(CONTROL, 32'd2 | part_at(chosen) << 6, 4'b1111);
            expect_word(CONTROL, 32'd2 | part_at(chosen) << 6);
            write(part_at(chosen), ~part_word(chosen), 4'b0000);
            write(CONTROL, 32'd1, 4'b0000);
            write(CONTROL, 32'd1 | part_at(chosen) << 6, 4'b0010);
            expect_word(STATUS, 32'd2);
            write(part_at(chosen), part_word(chosen), number / EVERY % 8 > 3 ? 4'b0001 : 4'b1111);
        end
    endtask

    initial begin
        $readmemh(SENT_FILE, sent);
        $readmemh(RECEIVED_FILE, received);
        repeat (3) @(negedge clk);
        reset = 1'b0;
        expect_reset;
<%- for at in read_only %>
        expect_error(${ at }$, 1'b0);
<%- endfor %>
        for (part = WORDS; part < ${ places }$; part = part + 1) expect_error(part << 2, 1'b1);
        expect_reset;
        while (number < POINTS) begin
            point = sent[number];
            result = received[number];
            irq_enabled = number / EVERY % 8 > 3;
            write(ENABLE, {31'd0, irq_enabled}, 4'b0001);
            write(ENABLE, {31'd0, ~irq_enabled}, 4'b1110);
            expect_word(ENABLE, {31'd0, irq_enabled});
            if (number / EVERY % 4 == 1) write_bytes;
            else write_operands;
            if (number / EVERY % 2 == 0) expect_operands;
            if (number / EVERY % 4 == 3) begin
                start_by_write(number / EVERY / 4 % PARTS);
            end else begin
                write(CONTROL, 32'd1, 4'b0001);
            end
            if (number / EVERY % 4 == 2) begin
                // The operands of another point must not change this computation.
                point = ~point;
                write_operands;
                expect_operands;
            end
            expect_results;
            expect_word(STATUS, 32'd2);
            check(irq === irq_enabled, "the interrupt");
            write(PENDING, 32'd0, 4'b1111);
            write(PENDING, 32'd1, 4'b1110);
            expect_word(PENDING, 32'd1);
            write(PENDING, 32'd1, 4'b0001);
            expect_word(PENDING, 32'd0);
            check(!irq, "an interrupt that was cleared");
            write(CONTROL, 32'd0, 4'b0001);
            expect_results;
            number = number + EVERY;
        end
<%- if let Some(depth) = queue %>
        // Software starts several points before it reads the first results, up to ${ depth }$ of them.
        write(ENABLE, 32'd0, 4'b1111);
        number = 0;
        while (number < POINTS) begin
            first = number;
            last = first + EVERY * (first / EVERY % ${ depth }$);
            for (number = first; number <= last && number < POINTS; number = number + EVERY) begin
                point = sent[number];
                write_operands;
                write(CONTROL, 32'd1, 4'b0001);
            end
            for (number = first; number <= last && number < POINTS; number = number + EVERY) begin
                result = received[number];
                expect_results;
            end
        end
        expect_word(STATUS, 32'd2);
        // Without room for its results, a start is an error and changes nothing.
        number = 0;
        point = sent[0];
        result = received[0];
        write_operands;
        write(CONTROL, 32'd0, 4'b1111);
        for (part = 0; part < ${ depth }$; part = part + 1) write(CONTROL, 32'd1, 4'b0001);
        access(CONTROL, 1'b1, 32'd3, 4'b0001);
        check(failed, "a start without room does not fail");
        expect_word(CONTROL, 32'd0);
        repeat (LIMIT) @(negedge clk);
        expect_word(STATUS, 32'd2 | 32'd${ depth }$ << 8);
        repeat (${ depth }$) expect_results;
        expect_word(STATUS, 32'd2);
<%- endif %>
        // A reset ends the computation.
        write(ENABLE, 32'd1, 4'b1111);
        write(CONTROL, 32'd1, 4'b0001);
        reset = 1'b1;
        @(negedge clk);
        @(negedge clk);
        reset = 1'b0;
        expect_reset;
        verdict;
    end
endmodule

`default_nettype wire
