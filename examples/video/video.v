// A picture without a frame buffer: a ball under the beam, and a core of Glint that shades it, a pixel a clock.

`default_nettype none

module video (
    input  wire       clk,      // of a pixel
    input  wire       rst_n,
    output reg        hsync,
    output reg        vsync,
    output reg        visible,
    output reg  [7:0] red,      // 0 where nothing is visible
    output reg  [7:0] green,
    output reg  [7:0] blue
);

    wire [9:0] column;
    wire [9:0] row;
    wire [2:0] signals;
    wire       line_end;
    wire       frame_end;
    beam beam (
        .clk(clk),
        .rst_n(rst_n),
        .column(column),
        .row(row),
        .hsync(signals[2]),
        .vsync(signals[1]),
        .visible(signals[0]),
        .line_end(line_end),
        .frame_end(frame_end)
    );

    wire signed [17:0] cos_gamma;
    wire        [7:0]  ball_red;
    wire        [7:0]  ball_green;
    wire        [7:0]  ball_blue;
    ball scene (
        .clk(clk),
        .rst_n(rst_n),
        .column(column),
        .row(row),
        .line_end(line_end),
        .frame_end(frame_end),
        .cos_gamma(cos_gamma),
        .red(ball_red),
        .green(ball_green),
        .blue(ball_blue)
    );

    // The scene takes 19 clocks.
    localparam DELAY = 19;
    reg [3*DELAY-1:0] waiting;
    always @(posedge clk) waiting <= rst_n ? {waiting[3*DELAY-4:0], signals} : {DELAY{3'b110}};

    // The highlight. What goes with a pixel, the core carries.
    wire        [7:0]  shine_red;
    wire        [7:0]  shine_green;
    wire        [7:0]  shine_blue;
    wire        [26:0] with_it;
    wire               valid;
    highlight core (
        .clk(clk),
        .rst_n(rst_n),
        .in_valid(1'b1),
        .cos_gamma(cos_gamma),
        .exponent(6'd48),
        .red(8'd230),
        .green(8'd220),
        .blue(8'd200),
        .side_in({waiting[3*DELAY-1:3*DELAY-3], ball_red, ball_green, ball_blue}),
        .out_valid(valid),
        .red_out(shine_red),
        .green_out(shine_green),
        .blue_out(shine_blue),
        .side_out(with_it)
    );

    function [7:0] sum(input [7:0] a, input [7:0] b);
        reg [8:0] both;
        begin
            both = {1'b0, a} + {1'b0, b};
            sum = both[8] ? 8'd255 : both[7:0];
        end
    endfunction

    wire seen = with_it[24] & valid;
    always @(posedge clk) begin
        hsync <= with_it[26] | ~valid;
        vsync <= with_it[25] | ~valid;
        visible <= seen;
        red <= seen ? sum(with_it[23:16], shine_red) : 8'd0;
        green <= seen ? sum(with_it[15:8], shine_green) : 8'd0;
        blue <= seen ? sum(with_it[7:0], shine_blue) : 8'd0;
    end
endmodule

`default_nettype wire
