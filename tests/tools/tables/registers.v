// Loads an image through the registers of a core, and computes every operand. Prints a result on each line.
module bench;
    reg clk = 1'b0;
    reg rst_n = 1'b0;
    reg write = 1'b0;
    reg [@HIGH@:2] write_at = 0;
    reg [31:0] write_data = 32'd0;
    reg read = 1'b0;
    reg [@HIGH@:2] read_at = 0;
    reg [63:0] word [0:@LAST@];
    reg [63:0] now;
    wire write_answer, write_error, read_answer, read_error, irq;
    wire [31:0] read_data;
    integer at;
    always #5 clk = ~clk;

    @NAME@_registers dut (
        .clk(clk), .rst_n(rst_n), .write(write), .write_at(write_at), .write_data(write_data),
        .write_bytes(4'hf), .write_answer(write_answer), .write_error(write_error), .read(read),
        .read_at(read_at), .read_answer(read_answer), .read_error(read_error),
        .read_data(read_data), .irq(irq)
    );

    task put(input [31:0] place, input [31:0] value);
        begin
            write = 1'b1;
            write_at = place[@HIGH@-2:0];
            write_data = value;
            #1;
            while (!write_answer) begin
                @(negedge clk);
                #1;
            end
            @(negedge clk);
            write = 1'b0;
        end
    endtask

    initial begin
        $readmemh("words.hex", word);
        repeat (2) @(negedge clk);
        rst_n = 1'b1;
        // The words follow a start directly, so that the first one waits for the computation.
        put(8, 0);
        put(5, 1);
        for (at = 0; at <= @LAST@; at = at + 1) begin
            now = word[at];
            @WRITES@
            put(@ADDRESS_PLACE@, at);
        end
        for (at = 0; at < 4096; at = at + 1) begin
            put(8, at);
            put(5, 1);
            read = 1'b1;
            read_at = @RESULT@;
            #1;
            while (!read_answer) begin
                @(negedge clk);
                #1;
            end
            @(negedge clk);
            read = 1'b0;
            $display("%0d", read_data);
        end
        $finish;
    end
endmodule
