// A span engine: it reads the operands of pixels that lie side by side, gives them to a core as a packet of AXI4-Stream, and
// writes what comes back into the frame buffer. It takes the clocks of the RAM that the processor leaves.
//
//  0x00  source       address of the operands, WORDS words a pixel
//  0x04  destination  address of the colours, a word a pixel
//  0x08  count        pixels, up to 1023; a write starts the span
//  0x0c  exponent     operands that are the same for all pixels
//  0x10  colour       red in the lowest byte
//
// While a span is under way, the first two can be written for the next one. Every other access waits for its end; a read does
// nothing else.

`default_nettype none

module span #(
    parameter WORDS = 1         // of operands a pixel, 1 or 2
) (
    input  wire        clk,
    input  wire        rst_n,
    // The processor.
    input  wire        request, // until `ready`
    input  wire        write,
    input  wire [2:0]  at,      // in words
    input  wire [31:0] data,
    output wire        ready,
    // The RAM: a request is taken where `ram_free` is 1, and what it reads is there in the next clock.
    input  wire        ram_free,
    output wire        ram_request,
    output wire        ram_write,
    output wire [15:2] ram_at,
    output wire [31:0] ram_data,
    input  wire [31:0] ram_read_data,
    // The core.
    output reg  [9:0]  exponent,
    output reg  [23:0] colour,
    output reg  [32*WORDS-1:0] operands,
    output wire        operands_last,
    output reg         operands_valid,
    input  wire        operands_ready,
    input  wire [23:0] result,
    input  wire        result_last,
    input  wire        result_valid,
    output wire        result_ready
);

    localparam SOURCE = 3'd0;
    localparam DESTINATION = 3'd1;
    localparam COUNT = 3'd2;
    localparam EXPONENT = 3'd3;
    localparam COLOUR = 3'd4;

    reg  [15:2] next_source;
    reg  [15:2] next_destination;
    reg  under_way;
    assign ready = request & ~((at >= COUNT) & under_way);
    wire taken = ready & write;
    wire start = taken & (at == COUNT);
    always @(posedge clk) begin
        if (taken & (at == SOURCE)) next_source <= data[15:2];
        if (taken & (at == DESTINATION)) next_destination <= data[15:2];
        if (taken & (at == EXPONENT)) exponent <= data[9:0];
        if (taken & (at == COLOUR)) colour <= data[23:0];
    end

    // Results go first, so that operands never wait in the core for them.
    reg  [15:2] source;
    reg  [15:2] destination;
    reg  [9:0]  left;           // pixels whose operands were not read yet
    reg  second;                // the next word is the second of its pixel
    reg  arrives;               // what was read in the clock before
    reg  complete;              // ... is the last word of its pixel
    wire last_word = (WORDS == 1) | second;
    wire room = (operands_ready | ~operands_valid) & ~(arrives & complete);
    wire wants = (left != 10'd0) & room;
    assign ram_request = result_valid | wants;
    assign ram_write = result_valid;
    assign ram_at = result_valid ? destination : source;
    assign ram_data = {8'd0, result};
    assign result_ready = ram_free;
    wire reads = ram_free & wants & ~result_valid;
    wire writes = ram_free & result_valid;

    always @(posedge clk) begin
        if (!rst_n) begin
            under_way <= 1'b0;
            left <= 10'd0;
            arrives <= 1'b0;
            operands_valid <= 1'b0;
        end else begin
            if (start) begin
                under_way <= data[9:0] != 10'd0;
                left <= data[9:0];
            end else begin
                if (writes & result_last) under_way <= 1'b0;
                if (reads & last_word) left <= left - 10'd1;
            end
            arrives <= reads;
            operands_valid <= (arrives & complete) | (operands_valid & ~operands_ready);
        end
    end
    wire [32*WORDS-1:0] following;
    generate
        if (WORDS == 1) assign following = ram_read_data;
        else assign following = {ram_read_data, operands[32*WORDS-1:32]};
    endgenerate
    always @(posedge clk) begin
        complete <= last_word;
        second <= ~start & (second ^ (reads & (WORDS != 1)));
        source <= start ? next_source : source + {13'd0, reads};
        destination <= start ? next_destination : destination + {13'd0, writes};
        if (arrives) operands <= following;
    end
    // The next pixel is not read before this one is taken.
    assign operands_last = left == 10'd0;
endmodule

`default_nettype wire
