// Loads an image into a pipeline, and computes every operand. Prints a result on each line.
module bench;
    reg clk = 1'b0;
    reg rst_n = 1'b0;
    reg in_valid = 1'b0;
    reg [11:0] x = 12'd0;
    reg table_write = 1'b0;
    reg [@ADDRESS@:0] table_address = 0;
    reg [63:0] word [0:@LAST@];
    wire [63:0] now = word[table_address];
    wire table_ready, in_ready, out_valid;
    wire [12:0] result_out;
    reg shows = 1'b0;
    integer at, seen, shown;
    always #5 clk = ~clk;

    @NAME@ dut (
        .clk(clk), .rst_n(rst_n), .in_valid(in_valid), .x(x),
        .table_write(table_write), .table_address(table_address),
        @PARTS@
        .out_ready(1'b1), .in_ready(in_ready), .out_valid(out_valid),
        .table_ready(table_ready), .result_out(result_out)
    );

    always @(negedge clk) if (shows && out_valid) begin
        $display("%0d", result_out);
        shown = shown + 1;
        if (shown == 4096) $finish;
    end

    initial begin
        $readmemh("words.hex", word);
        shown = 0;
        repeat (2) @(negedge clk);
        rst_n = 1'b1;
        // The first word waits for a point that is in the pipeline.
        in_valid = 1'b1;
        #1;
        while (!in_ready) @(negedge clk);
        @(negedge clk);
        in_valid = 1'b0;
        table_write = 1'b1;
        seen = 0;
        for (at = 0; at <= @LAST@; at = at + 1) begin
            table_address = at[@ADDRESS@:0];
            #1;
            while (!table_ready) begin
                seen = seen + 1;
                @(negedge clk);
                #1;
            end
            @(negedge clk);
        end
        table_write = 1'b0;
        if (seen == 0) $display("did not wait");
        shows = 1'b1;
        for (at = 0; at < 4096; at = at + 1) begin
            x = at[11:0];
            in_valid = 1'b1;
            #1;
            while (!in_ready) begin
                @(negedge clk);
                #1;
            end
            @(negedge clk);
        end
        in_valid = 1'b0;
    end
endmodule
