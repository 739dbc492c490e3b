// Eight bits a colour to four, a clock later: what is lost becomes a pattern of 4x4 pixels (Bayer's) in place of steps.

`default_nettype none

module dither (
    input  wire       clk,
    input  wire       hsync,
    input  wire       vsync,
    input  wire       visible,
    input  wire [7:0] red,
    input  wire [7:0] green,
    input  wire [7:0] blue,
    output reg        hsync_out,
    output reg        vsync_out,
    output reg        visible_out,
    output reg  [3:0] red_out,
    output reg  [3:0] green_out,
    output reg  [3:0] blue_out
);

    // The place in the pattern: each line begins at its left, each frame at its top.
    reg [1:0] x;
    reg [1:0] y;
    always @(posedge clk) begin
        x <= visible ? x + 2'd1 : 2'd0;
        if (!vsync) y <= 2'd0;
        else if (visible_out & ~visible) y <= y + 2'd1;
    end
    wire [3:0] threshold = {x[0] ^ y[0], y[0], x[1] ^ y[1], y[1]};

    // 15/16 of the colour are 0 to 240, so that white stays white.
    function [3:0] upper(input [7:0] colour, input [3:0] more);
        reg [7:0] level;
        begin
            level = colour - {4'd0, colour[7:4]} + {4'd0, more};
            upper = level[7:4];
        end
    endfunction

    always @(posedge clk) begin
        hsync_out <= hsync;
        vsync_out <= vsync;
        visible_out <= visible;
        red_out <= upper(red, threshold);
        green_out <= upper(green, threshold);
        blue_out <= upper(blue, threshold);
    end
endmodule

`default_nettype wire
