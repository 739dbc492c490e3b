// Loads an image into the core with a microprogram, and computes every operand. Prints a result on each line.
module bench;
    reg clk = 1'b0;
    reg rst_n = 1'b0;
    reg start = 1'b0;
    reg [11:0] x = 12'd0;
    reg x_write = 1'b0;
    reg table_write = 1'b0;
    reg [@ADDRESS@:0] table_address = 0;
    reg [63:0] word [0:@LAST@];
    wire [63:0] now = word[table_address];
    wire table_ready, valid, busy, done;
    wire [12:0] result_out;
    integer at, seen;
    always #5 clk = ~clk;

    @NAME@ dut (
        .clk(clk), .rst_n(rst_n), .start(start), .x(x), .x_write(x_write),
        .table_write(table_write), .table_address(table_address),
        @PARTS@
        .table_ready(table_ready), .valid(valid), .busy(busy), .done(done), .result_out(result_out)
    );

    initial begin
        $readmemh("words.hex", word);
        repeat (2) @(negedge clk);
        rst_n = 1'b1;
        // The first word waits for a computation that is under way.
        start = 1'b1;
        x_write = 1'b1;
        @(negedge clk);
        start = 1'b0;
        x_write = 1'b0;
        table_write = 1'b1;
        seen = 0;
        for (at = 0; at <= @LAST@; at = at + 1) begin
            table_address = at[@ADDRESS@:0];
            #1;
            while (!table_ready) begin
                if (!busy) begin $display("not ready while idle"); $finish; end
                seen = seen + 1;
                @(negedge clk);
            end
            @(negedge clk);
        end
        table_write = 1'b0;
        if (seen == 0) $display("did not wait");
        for (at = 0; at < 4096; at = at + 1) begin
            x = at[11:0];
            x_write = 1'b1;
            start = 1'b1;
            @(negedge clk);
            x_write = 1'b0;
            start = 1'b0;
            while (!valid) @(negedge clk);
            $display("%0d", result_out);
            while (busy) @(negedge clk);
        end
        $finish;
    end
endmodule
