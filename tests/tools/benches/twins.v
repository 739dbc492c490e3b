`timescale 1ns / 1ps
module twin #(parameter A = 18, parameter B = 18, parameter SIGNED = 0) (
    input wire clk, input wire enable, input wire [17:0] a, input wire [17:0] b
);
    wire [A+B-1:0] one, other;
    MODULE #(.A_WIDTH(A), .B_WIDTH(B), .SIGNED(SIGNED)) portable (
        .clk(clk), .enable(enable), .a(a[A-1:0]), .b(b[B-1:0]), .product(one));
    MODULE_ecp5 #(.A_WIDTH(A), .B_WIDTH(B), .SIGNED(SIGNED)) own (
        .clk(clk), .enable(enable), .a(a[A-1:0]), .b(b[B-1:0]), .product(other));
    reg loaded = 0;
    always @(posedge clk) begin
        loaded <= loaded | enable;
        if (loaded && one !== other) begin
            $display("FAIL %0d by %0d bits, signed %0d: %h and %h", A, B, SIGNED, one, other);
            $fatal;
        end
    end
endmodule

module twins;
    reg clk = 0, enable = 1;
    reg [17:0] a = 0, b = 0;
    genvar i, j;
    generate
        for (i = 1; i <= 18; i = i + STEP) begin : wide
            for (j = 1; j <= 18; j = j + STEP) begin : narrow
                twin #(.A(i), .B(j), .SIGNED(0)) without_sign (.clk(clk), .enable(enable), .a(a), .b(b));
                twin #(.A(i), .B(j), .SIGNED(1)) with_sign (.clk(clk), .enable(enable), .a(a), .b(b));
            end
        end
    endgenerate
    integer at;
    initial begin
        for (at = 0; at < 200; at = at + 1) begin
            #5 clk = 1;
            #1 enable = at < 3 || ($random & 1) == 1;
            a = at % 7 == 0 ? 18'h3ffff : at % 11 == 0 ? 18'h20000 : $random;
            b = at % 5 == 0 ? 18'h3ffff : at % 13 == 0 ? 18'h20000 : $random;
            #4 clk = 0;
        end
        $display("PASS");
        $finish;
    end
endmodule
