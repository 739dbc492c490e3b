// The iCEBreaker with 1BitSquared's 12-bit DVI Pmod at PMOD1A and PMOD1B: 25.125 MHz of the 12 that the board has.

`default_nettype none

module icebreaker (
    input  wire       clk_12mhz,
    output wire       dvi_clk,
    output wire       dvi_hsync,
    output wire       dvi_vsync,
    output wire       dvi_de,
    output wire [3:0] dvi_red,
    output wire [3:0] dvi_green,
    output wire [3:0] dvi_blue
);

    // 12 MHz * 67 / 32, as icepll says.
    wire clk;
    wire locked;
    SB_PLL40_PAD #(
        .FEEDBACK_PATH("SIMPLE"),
        .DIVR(4'd0),
        .DIVF(7'd66),
        .DIVQ(3'd5),
        .FILTER_RANGE(3'd1)
    ) pll (
        .PACKAGEPIN(clk_12mhz),
        .PLLOUTGLOBAL(clk),
        .LOCK(locked),
        .RESETB(1'b1),
        .BYPASS(1'b0)
    );

    // Registers of an iCE40 are 0 at power-up.
    reg [3:0] reset = 4'd0;
    always @(posedge clk) if (!(&reset)) reset <= reset + {3'd0, locked};

    wire       hsync;
    wire       vsync;
    wire       visible;
    wire [7:0] red;
    wire [7:0] green;
    wire [7:0] blue;
    video video (
        .clk(clk),
        .rst_n(&reset),
        .hsync(hsync),
        .vsync(vsync),
        .visible(visible),
        .red(red),
        .green(green),
        .blue(blue)
    );

    wire [14:0] pins;
    dither dither (
        .clk(clk),
        .hsync(hsync),
        .vsync(vsync),
        .visible(visible),
        .red(red),
        .green(green),
        .blue(blue),
        .hsync_out(pins[14]),
        .vsync_out(pins[13]),
        .visible_out(pins[12]),
        .red_out(pins[11:8]),
        .green_out(pins[7:4]),
        .blue_out(pins[3:0])
    );

    // Registers in the pins' own cells, so that all change at once.
    SB_IO #(
        .PIN_TYPE(6'b010100)
    ) outputs [14:0] (
        .PACKAGE_PIN({dvi_hsync, dvi_vsync, dvi_de, dvi_red, dvi_green, dvi_blue}),
        .OUTPUT_CLK(clk),
        .D_OUT_0(pins),
        .D_OUT_1(1'b0)
    );

    // The clock rises in the middle of a pixel.
    SB_IO #(
        .PIN_TYPE(6'b010000)
    ) clock_output (
        .PACKAGE_PIN(dvi_clk),
        .OUTPUT_CLK(clk),
        .D_OUT_0(1'b0),
        .D_OUT_1(1'b1)
    );
endmodule

`default_nettype wire
