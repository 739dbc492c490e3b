// The root of a number of 18 bits, with seven bits behind the point, a number a clock: 16 clocks later.
//
// A digit a clock, by the method for doing it on paper: root = floor(sqrt(radicand * 2^14)).

`default_nettype none

module root (
    input  wire        clk,
    input  wire [17:0] radicand,
    output wire [15:0] root
);

    // A digit more: the next two bits of the radicand go behind the remainder, which loses {root, 01} where it can.
    function [32:0] digit(input [16:0] remainder, input [15:0] known, input [1:0] two);
        reg [18:0] larger;
        begin
            larger = {remainder, two};
            digit = larger >= {1'b0, known, 2'b01}
                ? {larger[16:0] - {known[14:0], 2'b01}, known[14:0], 1'b1}
                : {larger[16:0], known[14:0], 1'b0};
        end
    endfunction

    wire [32:0] state  [0:16];
    wire [17:0] digits [0:16];  // bits of the radicand that are still to come
    assign state[0] = 33'd0;
    assign digits[0] = radicand;
    assign root = state[16][15:0];

    genvar stage;
    generate
        for (stage = 0; stage < 16; stage = stage + 1) begin : stages
            reg [32:0] after;
            reg [17:0] rest;
            always @(posedge clk) begin
                after <= digit(state[stage][32:16], state[stage][15:0], digits[stage][17:16]);
                rest <= {digits[stage][15:0], 2'd0};
            end
            assign state[stage + 1] = after;
            assign digits[stage + 1] = rest;
        end
    endgenerate

    wire unused = &{1'b0, state[16][32:16], digits[16]};
endmodule

`default_nettype wire
