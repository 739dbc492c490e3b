// A colour as ten bits of TMDS, a clock later: DVI 1.0, figure 3-5. While nothing is visible, `control` is sent.

`default_nettype none

module tmds (
    input  wire       clk,
    input  wire       visible,
    input  wire [7:0] colour,
    input  wire [1:0] control,
    output reg  [9:0] word      // bit 0 is sent first
);

    function [3:0] ones(input [7:0] bits);
        ones = {3'd0, bits[0]} + {3'd0, bits[1]} + {3'd0, bits[2]} + {3'd0, bits[3]}
            + {3'd0, bits[4]} + {3'd0, bits[5]} + {3'd0, bits[6]} + {3'd0, bits[7]};
    endfunction

    // Few edges: each bit tells whether the colour's next one differs, or whether it does not.
    wire [3:0] many = ones(colour);
    wire       inverse = many > 4'd4 || (many == 4'd4 && !colour[0]);
    wire [7:0] pairs = colour ^ {colour[6:0], 1'b0};
    wire [7:0] fours = pairs ^ {pairs[5:0], 2'b00};
    wire [7:0] edges = fours ^ {fours[3:0], 4'b0000} ^ (inverse ? 8'haa : 8'h00);

    // As many ones as zeros: `balance` is half of what is ahead, and a word that would add to it is inverted.
    reg  signed [3:0] balance;
    wire signed [3:0] excess = $signed(ones(edges)) - 4'sd4;
    wire              even = balance == 4'sd0 || excess == 4'sd0;
    wire              turned = even ? inverse : balance[3] == excess[3];
    wire signed [3:0] change = turned ? -excess : excess;
    // Bits 8 and 9 together: two ones, two zeros, or one of each.
    wire signed [3:0] marks = (turned == inverse) ? 4'sd0 : turned ? 4'sd1 : -4'sd1;

    always @(posedge clk) begin
        if (visible) begin
            word <= {turned, ~inverse, edges ^ {8{turned}}};
            balance <= balance + change + marks;
        end else begin
            case (control)
                2'b00: word <= 10'b1101010100;
                2'b01: word <= 10'b0010101011;
                2'b10: word <= 10'b0101010100;
                2'b11: word <= 10'b1010101011;
            endcase
            balance <= 4'sd0;
        end
    end
endmodule

`default_nettype wire
