// `rough` (UA 60139), written by hand: what the generated core is measured against.
//
// f = (n/2 * (cos(gamma +- dgamma) - 1) + 1)^2, one multiplier under the patent's ten-word
// program; bit for bit and clock for clock the generated device with
//
//   cosine u1.17 unsigned, exponent u10.0, colours u8.0, exact arithmetic with the clamp,
//   product.fraction 17 and intensity.fraction 16, both truncated, outputs to the nearest,
//   sine: direct, 1024 synchronous words of u0.17.
//
// Numbers in names and comments are those of the patent's figure.

`default_nettype none

module rough_hand #(
    parameter SINE_FILE = "rough_hand_sine.mem",
    // 1: the operands of the multiplier are registered, which the settling words leave time for.
    parameter HELD_OPERANDS = 0
) (
    input  wire        clk,
    input  wire        rst_n,
    input  wire        start,
    input  wire [17:0] cos_gamma,          // u1.17
    input  wire        cos_gamma_write,
    input  wire [17:0] cos_dgamma,         // u1.17
    input  wire        cos_dgamma_write,
    input  wire [9:0]  exponent,           // u10.0
    input  wire        exponent_write,
    input  wire        dgamma_negative,    // 0: cos(gamma + dgamma), 1: cos(gamma - dgamma)
    input  wire        dgamma_negative_write,
    input  wire [7:0]  red,                // u8.0
    input  wire        red_write,
    input  wire [7:0]  green,
    input  wire        green_write,
    input  wire [7:0]  blue,
    input  wire        blue_write,
    output wire        valid,
    output wire        busy,
    output wire        done,
    output wire [7:0]  red_out,            // u8.0
    output wire [7:0]  green_out,
    output wire [7:0]  blue_out
);
    // ---- Control unit 23 ------------------------------------------------------------------------

    reg       run;
    reg [3:0] word_address;

    always @(posedge clk)
        if (!rst_n) begin
            run          <= 1'b0;
            word_address <= 4'd0;
        end else if (!run) begin
            run          <= start;
        end else if (done) begin
            run          <= 1'b0;
            word_address <= 4'd0;
        end else begin
            word_address <= word_address + 4'd1;
        end

    // The patent's table; the address is 0 while idle, and word 0 loads nothing.
    reg [1:0] select;       // V1 V2: operands of the multiplier
    reg       sine_of_2;    // V3: ROM 18 is addressed by register 2 instead of 1
    reg       load_19_11;   // V4 V5
    reg       load_12;      // V6
    reg       load_13;      // V7

    always @* begin
        select     = 2'd0;
        sine_of_2  = 1'b0;
        load_19_11 = 1'b0;
        load_12    = 1'b0;
        load_13    = 1'b0;
        case (word_address)
            4'd1: load_19_11 = 1'b1;
            4'd2: begin select = 2'd1; sine_of_2 = 1'b1; end
            4'd3: begin select = 2'd1; sine_of_2 = 1'b1; load_12 = 1'b1; end
            4'd4: begin select = 2'd2; sine_of_2 = 1'b1; end
            4'd5: begin select = 2'd2; sine_of_2 = 1'b1; load_13 = 1'b1; end
            4'd6: begin select = 2'd3; sine_of_2 = 1'b1; end
            4'd7: begin select = 2'd3; sine_of_2 = 1'b1; load_13 = 1'b1; end
            4'd8: begin select = 2'd2; sine_of_2 = 1'b1; end
            default: ;
        endcase
    end

    assign valid = word_address == 4'd8;
    assign done  = word_address == 4'd9;
    assign busy  = run;

    // ---- Operand registers ----------------------------------------------------------------------

    reg [17:0] cos_gamma_reg;          // 1: u1.17, at most 1.0
    reg [17:0] cos_dgamma_reg;         // 2: u1.17, at most 1.0
    reg [9:0]  exponent_reg;           // 3
    reg        dgamma_negative_reg;    // 4
    reg [7:0]  red_reg;                // 5
    reg [7:0]  green_reg;              // 6
    reg [7:0]  blue_reg;               // 7

    always @(posedge clk)
        if (!run) begin
            // Values above 1.0 become 1.0.
            if (cos_gamma_write)
                cos_gamma_reg <= {cos_gamma[17], cos_gamma[16:0] & {17{!cos_gamma[17]}}};
            if (cos_dgamma_write)
                cos_dgamma_reg <= {cos_dgamma[17], cos_dgamma[16:0] & {17{!cos_dgamma[17]}}};
            if (exponent_write)        exponent_reg        <= exponent;
            if (dgamma_negative_write) dgamma_negative_reg <= dgamma_negative;
            if (red_write)             red_reg             <= red;
            if (green_write)           green_reg           <= green;
            if (blue_write)            blue_reg            <= blue;
        end

    // ---- Sine ROM 18 ----------------------------------------------------------------------------

    reg  [16:0] sine_rom [0:1023];     // u0.17
    reg  [16:0] sine;
    wire [17:0] sine_operand = sine_of_2 ? cos_dgamma_reg : cos_gamma_reg;    // 17
    wire [9:0]  sine_address = sine_operand[16:7] | {10{sine_operand[17]}};   // 1.0: the last entry

    initial $readmemh(SINE_FILE, sine_rom);

    always @(posedge clk)
        sine <= sine_rom[sine_address];

    // ---- Multiplier 10 --------------------------------------------------------------------------

    reg  [16:0] reg19_sin_gamma;   // u0.17
    reg  [17:0] reg11_cos_cos;     // u1.17
    reg  [16:0] reg12_sin_sin;     // u0.17
    reg  [16:0] reg13_result;      // s0.16

    // Adder 15 = register 11 -+ register 12 - 1.0, s1.17; the 1.0 concerns the top two bits only.
    wire        subtract = !dgamma_negative_reg;
    wire [18:0] cosine   = {1'b0, reg11_cos_cos}
                         + {{2{subtract}}, reg12_sin_sin ^ {17{subtract}}}
                         + {18'd0, subtract};
    wire [18:0] adder15  = {cosine[18] ^ !cosine[17], !cosine[17], cosine[16:0]};
    // Adder 16 = register 13 + 1.0: u1.16, since register 13 is at least -1.0.
    wire [16:0] adder16 = {!reg13_result[16], reg13_result[15:0]};

    reg  [17:0] choice8;
    reg  [17:0] choice9;
    wire [17:0] first_of_sine;

    always @*
        case (select)
            2'd0:    begin choice8 = cos_gamma_reg;   choice9 = cos_dgamma_reg;          end
            2'd1:    begin choice8 = first_of_sine;   choice9 = {1'b0, reg19_sin_gamma}; end
            2'd2:    begin choice8 = adder15[17:0];   choice9 = {8'd0, exponent_reg};    end
            default: begin choice8 = {1'b0, adder16}; choice9 = {1'b0, adder16};         end
        endcase

    // A word that settles comes before each that takes the product, so the operands may be a clock
    // late; all but the sine, which its ROM has only just delivered in word 3.
    wire [17:0] first;
    wire [17:0] second;
    wire        negative;    // adder 15, as the multiplier sees it

    generate
        if (HELD_OPERANDS != 0) begin : held
            reg [17:0] first_held;
            reg [17:0] second_held;
            reg        negative_held;
            always @(posedge clk) begin
                first_held    <= choice8;
                second_held   <= choice9;
                negative_held <= adder15[18];
            end
            assign first_of_sine = cos_gamma_reg;    // any choice will do, and this one is free
            assign first         = select == 2'd1 ? {1'b0, sine} : first_held;
            assign second        = second_held;
            assign negative      = negative_held;
        end else begin : direct
            assign first_of_sine = {1'b0, sine};
            assign first         = choice8;
            assign second        = choice9;
            assign negative      = adder15[18];
        end
    endgenerate

    wire [35:0] product = first * second;

    // The multiplier takes the low 18 bits of adder 15 as unsigned, so a negative one leaves the
    // product n/2 * 4.0 too large: n, at the weight of bit 18.
    wire [10:0] above_one = {1'b0, product[27:18]} - {1'b0, exponent_reg & {10{negative}}};

    // ---- Result registers: every narrowing truncates --------------------------------------------

    wire        squared  = select[0];                  // of the words that load register 13
    wire        facing   = cos_gamma_reg != 18'd0;
    wire        too_low  = !squared && above_one[10] && !(&above_one[9:0]);
    wire        too_high = squared ? |product[33:32] : !above_one[10] && |above_one[9:0];
    wire [15:0] fraction = squared ? product[31:16] : product[17:2];

    always @(posedge clk) begin
        if (load_19_11) begin
            reg19_sin_gamma <= sine;
            reg11_cos_cos   <= product[34:17];
        end
        if (load_12)
            reg12_sin_sin <= product[33:17];
        if (load_13) begin
            if (too_low || !facing)
                reg13_result <= 17'h10000;
            else
                reg13_result <= {!squared && above_one[10], fraction | {16{too_high}}};
        end
    end

    // ---- Multipliers 20, 21, 22: to the nearest unit; 255 at most, since f < 1.0 ----------------

    wire [15:0] f = reg13_result[15:0];
    wire [23:0] red_product   = f * red_reg   + 24'h008000;
    wire [23:0] green_product = f * green_reg + 24'h008000;
    wire [23:0] blue_product  = f * blue_reg  + 24'h008000;

    wire unused = &{1'b0, sine_operand[6:0], product[35], product[1:0], red_product[15:0],
                    green_product[15:0], blue_product[15:0]};    // dropped by the narrowings

    assign red_out   = red_product[23:16];
    assign green_out = green_product[23:16];
    assign blue_out  = blue_product[23:16];
endmodule

`default_nettype wire
