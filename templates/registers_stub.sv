module ${ name }$_registers (
    input wire clk,
    input wire rst_n,
    input wire write,
    input wire [${ address_high }$:2] write_at,
    input wire [31:0] write_data,
    input wire [3:0] write_bytes,
    output wire write_answer,
    output wire write_error,
    input wire read,
    input wire [${ address_high }$:2] read_at,
    output wire read_answer,
    output wire read_error,
    output wire [31:0] read_data,
    output wire irq
);
    (* anyseq *) reg answers_write;
    (* anyseq *) reg answers_read;
    (* anyseq *) reg [34:0] any;
    assign write_answer = write & answers_write;
    assign read_answer = read & answers_read;
    assign {irq, write_error, read_error, read_data} = any;
endmodule
