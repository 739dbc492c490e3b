// The ULX3S and its GPDI connector: the board's 25 MHz for the pixels, 125 MHz for pairs of bits.

`default_nettype none

module ulx3s (
    input  wire       clk_25mhz,
    output wire [3:0] gpdi_dp     // blue, green, red, clock; the cells drive the other wire of each pair
);

    wire clk;
    wire bit_clk;
    wire locked;
    (* FREQUENCY_PIN_CLKI = "25", FREQUENCY_PIN_CLKOP = "125", FREQUENCY_PIN_CLKOS = "25" *)
    EHXPLLL #(
        .CLKI_DIV(1),
        .CLKFB_DIV(5),
        .CLKOP_DIV(5),
        .CLKOP_CPHASE(4),
        .CLKOS_ENABLE("ENABLED"),
        .CLKOS_DIV(25),
        .CLKOS_CPHASE(4),
        .FEEDBK_PATH("CLKOP")
    ) pll (
        .CLKI(clk_25mhz),
        .CLKFB(bit_clk),
        .CLKOP(bit_clk),
        .CLKOS(clk),
        .LOCK(locked),
        .RST(1'b0),
        .STDBY(1'b0),
        .PHASESEL0(1'b0),
        .PHASESEL1(1'b0),
        .PHASEDIR(1'b0),
        .PHASESTEP(1'b0),
        .PHASELOADREG(1'b0),
        .ENCLKOP(1'b0)
    );

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

    wire [29:0] words;
    tmds encoders [2:0] (
        .clk(clk),
        .visible(visible),
        .colour({red, green, blue}),
        .control({4'b0000, vsync, hsync}),
        .word(words)
    );

    // To the faster clock: `pixel` changes with the words, and they are taken two or three of its periods later.
    reg       pixel = 1'b0;
    reg [2:0] seen = 3'b000;
    always @(posedge clk) pixel <= ~pixel;
    always @(posedge bit_clk) seen <= {seen[1:0], pixel};
    wire load = seen[2] ^ seen[1];

    genvar pair;
    generate
        for (pair = 0; pair < 4; pair = pair + 1) begin : pairs
            reg  [9:0] rest;
            wire [9:0] word;
            if (pair < 3) assign word = words[10*pair +: 10];
            else assign word = 10'b0000011111;
            always @(posedge bit_clk) rest <= load ? word : {2'b00, rest[9:2]};
            ODDRX1F serial (
                .SCLK(bit_clk),
                .RST(1'b0),
                .D0(rest[0]),
                .D1(rest[1]),
                .Q(gpdi_dp[pair])
            );
        end
    endgenerate
endmodule

`default_nettype wire
