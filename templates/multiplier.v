<%- for line in header %>${ line }$
<% endfor %>
`default_nettype none

module ${ name }$ #(
    parameter A_WIDTH = 18,
    parameter B_WIDTH = 18,
    parameter SIGNED = 0  // 1 if factors and product are two's complement, 0 if unsigned
) (
    input  wire                       clk,
    input  wire                       enable,
    input  wire [A_WIDTH-1:0]         a,
    input  wire [B_WIDTH-1:0]         b,
    output reg  [A_WIDTH+B_WIDTH-1:0] product
);

    generate
        if (SIGNED != 0) begin : with_sign
            always @(posedge clk) if (enable) product <= $signed(a) * $signed(b);
        end else begin : without_sign
            always @(posedge clk) if (enable) product <= a * b;
        end
    endgenerate
endmodule

`default_nettype wire
