// What a user of PeakRDL-etana's block writes beside it so that the registers do what the map says:
// starts by control and by a write to an operand, waits for the computation that is under way, and
// remembers that one has ended.

`default_nettype none

module start (
    input  wire       clk,
    input  wire       rst_n,
    // The request on the bus, which is kept from the block while `hold` is high.
    input  wire       write,
    input  wire       read,
    input  wire [3:0] at,              // in words
    input  wire       bit_of_start,    // control.start and its byte strobe
    output wire       hold,
    // The block.
    input  wire       control_start,   // a pulse
    input  wire       start_on_write,
    input  wire [3:0] start_word,
    input  wire       interrupt_enable,
    input  wire       interrupt_pending,
    output wire       status_busy,
    output reg        status_finished,
    output wire       irq,
    // The core.
    output wire       core_start,
    input  wire       core_busy,
    input  wire       core_done
);

    localparam CONTROL = 4'd5;
    localparam LAST_OPERAND = 4'd12;
    localparam RESULTS = 4'd13;

    wire operand = at[3] & (at <= LAST_OPERAND);
    wire by_operand = start_on_write & operand & (at == start_word);
    wire by_control = (at == CONTROL) & bit_of_start;
    reg  operand_start;
    assign core_start = control_start | operand_start;
    assign status_busy = core_start | core_busy;
    assign hold = status_busy & (write ? by_operand | by_control : read & (at == RESULTS));
    assign irq = interrupt_enable & interrupt_pending;

    always @(posedge clk) begin
        operand_start <= rst_n & write & by_operand & ~hold;
        status_finished <= rst_n & (core_done | (status_finished & ~core_start));
    end
endmodule

`default_nettype wire
