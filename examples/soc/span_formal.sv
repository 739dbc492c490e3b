// What is proved of the span engine: each pixel of a span is read once, offered once with its own operands, the last of them
// as the last, and its result written once to its own place, whatever the RAM, the core and the processor do; and that a span
// never stops of itself. For WORDS words of operands a pixel, 1 here; for 2, change the parameter below:
//   $ yosys -q span_formal.ys
//   $ yosys-smtbmc -s z3 --unroll -t 3 span_formal.smt2
//   $ yosys-smtbmc -s z3 --unroll -i -t 2 span_formal.smt2

`default_nettype none

module span_formal #(
    parameter WORDS = 1
) (
    input wire clk,
    input wire rst_n,
    input wire request,
    input wire write,
    input wire [2:0] at,
    input wire [31:0] data,
    input wire ram_free,
    input wire [31:0] any_read_data,
    input wire operands_ready,
    input wire any_result,
    input wire [23:0] result
);
    wire ready;
    wire ram_request;
    wire ram_write;
    wire [15:2] ram_at;
    wire [31:0] ram_data;
    wire [9:0] exponent;
    wire [23:0] colour;
    wire [32*WORDS-1:0] operands;
    wire operands_last;
    wire operands_valid;
    wire result_ready;

    // Of the RAM one word is followed, whichever; it is not written.
    (* anyconst *) reg [15:2] word_at;
    (* anyconst *) reg [31:0] word;
    reg reads_word;
    wire [31:0] ram_read_data = reads_word ? word : any_read_data;
    wire reads = ram_free && ram_request && !ram_write;
    always @(posedge clk) reads_word <= reads && ram_at == word_at;

    // The core gives a result for each pixel, in order, when it will; what it offers stays.
    reg [9:0] pixels;       // of this span
    reg [9:0] taken;        // by the core
    reg [9:0] written;
    reg result_stays;
    wire result_valid = taken != written && (any_result || result_stays);
    wire result_last = written == pixels - 10'd1;

    span #(.WORDS(WORDS)) dut (
        .clk(clk),
        .rst_n(rst_n),
        .request(request),
        .write(write),
        .at(at),
        .data(data),
        .ready(ready),
        .ram_free(ram_free),
        .ram_request(ram_request),
        .ram_write(ram_write),
        .ram_at(ram_at),
        .ram_data(ram_data),
        .ram_read_data(ram_read_data),
        .exponent(exponent),
        .colour(colour),
        .operands(operands),
        .operands_last(operands_last),
        .operands_valid(operands_valid),
        .operands_ready(operands_ready),
        .result(result),
        .result_last(result_last),
        .result_valid(result_valid),
        .result_ready(result_ready)
    );

    // Internal signals that the proof refers to.
    (* hierconn *) wire [15:2] \dut.next_source ;
    (* hierconn *) wire [15:2] \dut.next_destination ;
    (* hierconn *) wire \dut.under_way ;
    (* hierconn *) wire \dut.start ;
    (* hierconn *) wire [15:2] \dut.source ;
    (* hierconn *) wire [15:2] \dut.destination ;
    (* hierconn *) wire [9:0] \dut.left ;
    (* hierconn *) wire \dut.second ;
    (* hierconn *) wire \dut.arrives ;
    (* hierconn *) wire \dut.complete ;

    // What the processor wrote last, and what it wrote at all.
    reg [15:2] asked_source;
    reg [15:2] asked_destination;
    reg [9:0] asked_exponent;
    reg [23:0] asked_colour;
    reg [4:0] known;        // one bit each, by `at`
    initial known = 5'd0;
    always @(posedge clk) if (request && write && ready) begin
        if (at < 3'd5) known[at] <= 1'b1;
        case (at)
            3'd0: asked_source <= data[15:2];
            3'd1: asked_destination <= data[15:2];
            3'd3: asked_exponent <= data[9:0];
            3'd4: asked_colour <= data[23:0];
            default: ;
        endcase
    end

    // The span: where it began, and how far it is.
    reg [15:2] from;
    reg [15:2] to;
    reg [11:0] words;       // read
    wire takes = operands_valid && operands_ready;
    wire writes = result_valid && result_ready;
    always @(posedge clk) begin
        result_stays <= rst_n && result_valid && !result_ready;
        if (!rst_n) begin
            pixels <= 10'd0;
            taken <= 10'd0;
            written <= 10'd0;
            words <= 12'd0;
        end else if (dut.start) begin
            pixels <= data[9:0];
            from <= dut.next_source;
            to <= dut.next_destination;
            taken <= 10'd0;
            written <= 10'd0;
            words <= 12'd0;
        end else begin
            taken <= taken + takes;
            written <= written + writes;
            words <= words + reads;
        end
    end

    // The reset comes first; the state before it is arbitrary.
    always @* if ($initstate) assume (!rst_n);

    // Words of the pixels that the core has, and with the one that is offered.
    wire [11:0] gone = WORDS * taken;
    wire [11:0] here = gone + (operands_valid ? WORDS : 0);
    always @* if (!$initstate) begin
        // The processor waits for a span alone, and what it asks then is not done.
        if (request && !ready) assert (dut.under_way);
        if (dut.start) assert (request && write && at == 3'd2 && !dut.under_way);
        // What the processor wrote is what the next span begins with, and what the core is given.
        if (known[0]) assert (dut.next_source == asked_source);
        if (known[1]) assert (dut.next_destination == asked_destination);
        if (known[3]) assert (exponent == asked_exponent);
        if (known[4]) assert (colour == asked_colour);
        // Addresses of the next span never wait.
        if (request && at < 3'd2) assert (ready);
        // Each pixel is read, taken and written once, and the span ends with the last.
        assert (words <= WORDS * pixels);
        assert (taken <= pixels && written <= taken);
        assert (dut.left == pixels - words / WORDS);
        assert (!dut.under_way || dut.second == (words % WORDS != 0));
        assert (dut.under_way == (written != pixels));
        assert (!dut.under_way || dut.source == from + words);
        assert (!dut.under_way || dut.destination == to + written);
        // What was read is with the core or offered, or it waits for the rest of its pixel; the last word may be on its way.
        assert (words == here || !operands_valid && words - here <= WORDS);
        assert (dut.arrives || words - here < WORDS);
        assert (!dut.arrives || words != here && dut.complete == (words % WORDS == 0));
        // The last is the last.
        assert (!operands_valid || operands_last == (taken == pixels - 10'd1));
        // A result leaves the core where the RAM takes it.
        if (writes) assert (ram_free && ram_request && ram_write);
        // A span that is not at its end asks the RAM, or waits for it, or for the core.
        if (dut.under_way) assert (ram_request || dut.arrives || operands_valid || taken != written);
        // To its own place.
        if (ram_write) assert (ram_at == to + written && ram_data == result);
        // The word that is followed is in its place.
        if (dut.arrives) assert (reads_word == (from + words - 14'd1 == word_at));
        if (operands_valid && WORDS == 2 && from + gone == word_at) assert (operands[31:0] == word);
        if (operands_valid && from + gone + (WORDS - 1) == word_at) assert (operands[32*WORDS-1:32*WORDS-32] == word);
        if (words != here && WORDS == 2 && words - here - dut.arrives == 1 && from + gone == word_at) begin
            assert (operands[32*WORDS-1:32*WORDS-32] == word);
        end
    end
    always @(posedge clk) if (!$initstate && $past(!$initstate && rst_n)) begin
        // What is offered stays until it is taken.
        if ($past(operands_valid && !operands_ready)) begin
            assert (operands_valid && $stable(operands) && $stable(operands_last));
        end
        // The operands that are the same for all pixels stay while a span is under way.
        if ($past(dut.under_way)) assert ($stable(exponent) && $stable(colour));
    end
endmodule

`default_nettype wire
