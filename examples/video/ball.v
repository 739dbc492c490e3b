// A ball and a light that circles around the eye: for the pixel under the beam the operands of its highlight, and its colour
// without it, 19 clocks later. There is no multiplier in it.
//
// Pixels are at odd places x and y, half a pixel apart, the ball's centre at 0. With the radius 448, the normal is
// (x, y, z)/448, z = sqrt(448^2 - x^2 - y^2). The half vector is (hx, hy, 7/8), and hx and hy turn by 1/64 a frame. Then
//
//   cos gamma = (x hx + y hy)/448 + z/512          the first part changes by a constant from a pixel to the next
//   normal . light = 7/4 cos gamma - z/448         light = 2 (half . eye) half - eye
//
// examples/video/scene.py says the same in integers; its frames are these, bit for bit.

`default_nettype none

module ball (
    input  wire               clk,
    input  wire               rst_n,
    input  wire        [9:0]  column,
    input  wire        [9:0]  row,
    input  wire               line_end,
    input  wire               frame_end,
    output reg  signed [17:0] cos_gamma,  // s1.16; 0 where there is no highlight
    output reg         [7:0]  red,
    output reg         [7:0]  green,
    output reg         [7:0]  blue
);

    // z^2, negative beside the ball: 448^2 - x^2 - y^2 by differences, x = 2 column - 639, y = 479 - 2 row.
    localparam signed [20:0] SQUARE_FIRST = -21'sd437058;  // 448^2 - 639^2 - 479^2
    reg  signed [20:0] square;
    reg  signed [20:0] square_line;  // at the begin of the next line
    wire signed [20:0] x_step = 21'sd2552 - $signed({8'd0, column, 3'd0});  // x^2 - (x + 2)^2
    wire signed [20:0] y_step = 21'sd1904 - $signed({8'd0, row, 3'd0});     // of the line after the next
    always @(posedge clk) begin
        if (!rst_n || frame_end) begin
            square <= SQUARE_FIRST;
            square_line <= SQUARE_FIRST + 21'sd1912;
        end else if (line_end) begin
            square <= square_line;
            square_line <= square_line + y_step;
        end else begin
            square <= square + x_step;
        end
    end

    // z, with seven bits behind the point. What goes with it waits as long.
    localparam DELAY = 16;
    wire [15:0] z;
    root height (
        .clk(clk),
        .radicand(square[17:0]),
        .root(z)
    );
    reg [DELAY-1:0] covered;
    reg [DELAY-1:0] line_ends;
    reg [DELAY-1:0] frame_ends;
    always @(posedge clk) begin
        covered <= {covered[DELAY-2:0], ~square[20]};
        line_ends <= {line_ends[DELAY-2:0], line_end & rst_n};
        frame_ends <= {frame_ends[DELAY-2:0], frame_end | ~rst_n};
    end

    // The half vector, s0.24 and divided by 448. It turns below the picture, where nothing follows it.
    localparam signed [15:0] HX_FIRST = -16'sd10877;
    localparam signed [15:0] HY_FIRST = 16'sd14503;
    reg  signed [15:0] hx;
    reg  signed [15:0] hy;
    wire signed [15:0] hx_next = hx - (hy >>> 6);
    wire turn = line_end && row == 10'd500;
    always @(posedge clk) begin
        if (!rst_n) begin
            hx <= HX_FIRST;
            hy <= HY_FIRST;
        end else if (turn) begin
            hx <= hx_next;
            hy <= hy + (hx_next >>> 6);
        end
    end

    // x hx + y hy, s1.24, and the same at the begin of a line; 479 hy - 639 hx in the first.
    reg  signed [25:0] across;
    reg  signed [25:0] across_line;
    reg  signed [25:0] across_first;
    wire signed [25:0] hx_wide = {{10{hx[15]}}, hx};
    wire signed [25:0] hy_wide = {{10{hy[15]}}, hy};
    wire signed [25:0] across_down = across_line - (hy_wide <<< 1);
    always @(posedge clk) begin
        across_first <= (hy_wide <<< 9) - (hy_wide <<< 5) - hy_wide
            - (hx_wide <<< 9) - (hx_wide <<< 7) + hx_wide;
        if (frame_ends[DELAY-1]) begin
            across <= across_first;
            across_line <= across_first;
        end else if (line_ends[DELAY-1]) begin
            across <= across_down;
            across_line <= across_down;
        end else begin
            across <= across + (hx_wide <<< 1);
        end
    end

    // cos gamma, s1.16
    wire signed [25:0] cosine = across + $signed({2'b00, z, 8'd0});
    reg  signed [17:0] cosine_1;
    reg         [15:0] z_1;
    reg                covered_1;
    always @(posedge clk) begin
        cosine_1 <= cosine[25:8];
        z_1 <= z;
        covered_1 <= covered[DELAY-1];
    end

    // normal . light, s2.16: 1/448 is 8/7 of 1/512, and 8/7 is 1 + 1/8 + 1/64 + 1/512 here
    wire signed [18:0] cosine_wide = {cosine_1[17], cosine_1};
    wire        [17:0] facing_eye = {2'd0, z_1} + {5'd0, z_1[15:3]} + {8'd0, z_1[15:6]} + {11'd0, z_1[15:9]};
    wire signed [18:0] facing_light =
        (cosine_wide <<< 1) - (cosine_wide >>> 2) - $signed({1'b0, facing_eye});
    reg                lit_2;
    reg         [7:0]  share_2;  // of the light that comes, 255/256 at most
    reg  signed [17:0] cosine_2;
    reg                covered_2;
    always @(posedge clk) begin
        lit_2 <= covered_1 & ~facing_light[18];
        share_2 <= facing_light[18] ? 8'd0 : (|facing_light[17:16]) ? 8'd255 : facing_light[15:8];
        cosine_2 <= cosine_1;
        covered_2 <= covered_1;
    end

    // Ambient and diffuse light, and the colour: 3/32, 11/32 and 17/32 of it
    wire [9:0]  light = 10'd32 + {2'd0, share_2} - {4'd0, share_2[7:2]};
    wire [13:0] light_3 = {4'd0, light} + {3'd0, light, 1'b0};
    wire [13:0] light_11 = light_3 + {1'b0, light, 3'd0};
    wire [13:0] light_17 = {light, 4'd0} + {4'd0, light};
    always @(posedge clk) begin
        cos_gamma <= lit_2 ? cosine_2 : 18'sd0;
        red <= covered_2 ? {light_3[12:5]} : 8'd13;
        green <= covered_2 ? {light_11[12:5]} : 8'd15;
        blue <= covered_2 ? {light_17[12:5]} : 8'd20;
    end

    wire unused = &{1'b0, square[19:18], cosine[7:0], facing_light[7:0], light_3[13], light_3[4:0], light_11[13], light_11[4:0],
        light_17[13], light_17[4:0]};
endmodule

`default_nettype wire
