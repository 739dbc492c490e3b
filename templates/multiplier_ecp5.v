<%- for line in header %>${ line }$
<% endfor %>
`default_nettype none

module ${ name }$ #(
    parameter A_WIDTH = 18,  // at most 18, like B_WIDTH
    parameter B_WIDTH = 18,
    parameter SIGNED = 0  // 1 if factors and product are two's complement, 0 if unsigned
) (
    input  wire                       clk,
    input  wire                       enable,
    input  wire [A_WIDTH-1:0]         a,
    input  wire [B_WIDTH-1:0]         b,
    output wire [A_WIDTH+B_WIDTH-1:0] product
);

    // The factors, extended to 18 bits with copies of the sign bit or with zeros.
    wire is_signed = SIGNED != 0;
    wire [35:0] a_wide = {{36 - A_WIDTH{is_signed & a[A_WIDTH-1]}}, a};
    wire [35:0] b_wide = {{36 - B_WIDTH{is_signed & b[B_WIDTH-1]}}, b};
    wire [35:0] whole;
    assign product = whole[A_WIDTH+B_WIDTH-1:0];

    MULT18X18D #(
        .REG_INPUTA_CLK("NONE"),
        .REG_INPUTB_CLK("NONE"),
        .REG_INPUTC_CLK("NONE"),
        .REG_PIPELINE_CLK("NONE"),
        .REG_OUTPUT_CLK("CLK0"),
        .REG_OUTPUT_CE("CE0"),
        .REG_OUTPUT_RST("RST0")
    ) block (
        .CLK0(clk), .CLK1(1'b0), .CLK2(1'b0), .CLK3(1'b0),
        .CE0(enable), .CE1(1'b0), .CE2(1'b0), .CE3(1'b0),
        .RST0(1'b0), .RST1(1'b0), .RST2(1'b0), .RST3(1'b0),
        .SIGNEDA(is_signed), .SIGNEDB(is_signed), .SOURCEA(1'b0), .SOURCEB(1'b0),
<%- for line in pins %>
        ${ line }$
<%- endfor %>
    );
endmodule

`default_nettype wire
