module delay #(
    parameter WIDTH  = 8,
    parameter WORDS  = 2,
    parameter BITS   = 1,  // the width of slot
    parameter MEMORY = 1   // 1: a memory, 0: registers
) (
    input  wire             clk, rst_n, enable,
    input  wire [WIDTH-1:0] entering,
    output reg  [WIDTH-1:0] leaving
);
    generate
        if (MEMORY != 0) begin : memory
            localparam [BITS-1:0] LAST = WORDS[BITS-1:0] - 1'b1;
            reg  [BITS-1:0]  slot;
            reg  [WIDTH-1:0] words [0:WORDS-1];
            // If WORDS is a power of two, slot + 1 wraps around by itself.
            wire around = WORDS != 1 << BITS && slot == LAST;
            always @(posedge clk) begin
                if (!rst_n) slot <= {BITS{1'b0}};
                else if (enable) slot <= around ? {BITS{1'b0}} : slot + 1'b1;
                if (enable) begin
                    leaving <= words[slot];
                    words[slot] <= entering;
                end
            end
        end else begin : registers
            reg  [WIDTH*WORDS-1:0] words;
            wire unused = &{1'b0, rst_n};
            always @(posedge clk) if (enable) {leaving, words} <= {words, entering};
        end
    endgenerate
endmodule
