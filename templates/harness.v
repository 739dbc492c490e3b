// ${ top }$: ${ name }$ between shift registers, with only four pins
`default_nettype none

module ${ top }$ (
    input  wire clk,
    input  wire in,    // shifted into the inputs of the core
    input  wire take,  // 1 loads the captured outputs, 0 shifts them out
    output wire out
);
    reg  [${ fed - 1 }$:0] fed;
    wire [${ captured - 1 }$:0] result;
    reg  [${ captured - 1 }$:0] captured;
    reg  [${ captured - 1 }$:0] taken;

    always @(posedge clk) begin
        fed      <= {fed[${ fed - 2 }$:0], in};
        captured <= result;
        taken    <= take ? captured : {1'b0, taken[${ captured - 1 }$:1]};
    end
    assign out = taken[0];

    ${ name }$ ${ core }$ (
<%- for slice in inputs %>
        .${ slice.port }$(fed[${ slice.high }$:${ slice.low }$]),
<%- endfor %>
<%- for slice in outputs %>
        .${ slice.port }$(result[${ slice.high }$:${ slice.low }$]),
<%- endfor %>
        .clk(clk)
    );
endmodule

`default_nettype wire
