module bench;
    reg clk = 1'b0;
    reg start = 1'b0;
    wire valid, busy, done;
    wire [7:0] red_out;
    core dut (
        .clk(clk), .rst_n(1'b1), .start(start), .cos_gamma(21'd1048576), .cos_gamma_write(start),
        .exponent(10'd20), .exponent_write(start), .red(8'd200), .red_write(start),
        .green(8'd0), .green_write(start), .blue(8'd0), .blue_write(start),
        .valid(valid), .busy(busy), .done(done), .red_out(red_out), .green_out(), .blue_out()
    );
    always #5 clk = ~clk;
    initial begin
        #1 $display("before %b %b", busy, red_out);
        @(negedge clk) start = 1'b1;
        @(negedge clk) start = 1'b0;
        repeat (20) @(negedge clk) if (valid) $display("valid %0d", red_out);
        $finish;
    end
endmodule
