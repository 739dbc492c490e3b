`default_nettype none
module counter (
    input  wire       clk,
    input  wire       rst_n,
    output reg  [3:0] count
);
    always @(posedge clk)
        if (!rst_n) count <= 4'd0;
        else        count <= count + 4'd1;
endmodule
`default_nettype wire
