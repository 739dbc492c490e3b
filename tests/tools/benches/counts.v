module tb;
    reg clk = 0;
    reg rst_n = 0;
    wire [3:0] count;
    counter dut (.clk(clk), .rst_n(rst_n), .count(count));
    always #5 clk = ~clk;
    initial begin
        @(negedge clk) rst_n = 1;
        repeat (5) @(negedge clk);
        WAIT
        if (count === EXPECTED) $display("PASS: 5 clocks");
        else begin
            $display("FAIL: count is %0d", count);
            $fatal(1, "mismatch");
        end
        $finish;
    end
endmodule
