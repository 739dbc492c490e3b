// Runs the points of rough_hand_points.mem back to back through rough_hand and compares results and
// latency. A point is {cos_gamma, cos_dgamma, exponent, dgamma_negative, red, green, blue, and the
// three expected outputs}.
module rough_hand_tb;
    parameter POINTS = 1;

    reg         clk = 0;
    reg         rst_n = 0;
    reg         start = 0;
    reg  [94:0] points [0:POINTS-1];
    reg  [94:0] point;
    integer     at;
    integer     clocks;
    integer     errors = 0;
    wire [7:0]  red_out, green_out, blue_out;
    wire        valid, busy, done;

    // All strobes are high all the time: writes while busy must not matter.
    rough_hand dut (
        .clk(clk), .rst_n(rst_n), .start(start),
        .cos_gamma(point[94:77]), .cos_gamma_write(1'b1),
        .cos_dgamma(point[76:59]), .cos_dgamma_write(1'b1),
        .exponent(point[58:49]), .exponent_write(1'b1),
        .dgamma_negative(point[48]), .dgamma_negative_write(1'b1),
        .red(point[47:40]), .red_write(1'b1),
        .green(point[39:32]), .green_write(1'b1),
        .blue(point[31:24]), .blue_write(1'b1),
        .valid(valid), .busy(busy), .done(done),
        .red_out(red_out), .green_out(green_out), .blue_out(blue_out)
    );

    always #5 clk = ~clk;

    initial begin
        $readmemh("rough_hand_points.mem", points);
        repeat (2) @(negedge clk);
        rst_n = 1;
        for (at = 0; at < POINTS; at = at + 1) begin
            point = points[at];
            start = 1;
            @(negedge clk);
            start = 0;
            point = ~point;
            // Word 0 executes now; word 8 is valid, word 9 the end.
            for (clocks = 0; clocks < 10; clocks = clocks + 1) begin
                if (!busy || valid !== (clocks == 8) || done !== (clocks == 9)) begin
                    $display("point %0d: wrong handshake in word %0d", at, clocks);
                    errors = errors + 1;
                end
                if (valid && {red_out, green_out, blue_out} !== points[at][23:0]) begin
                    if (errors < 20)
                        $display("point %0d %h: %h %h %h", at, points[at],
                                 red_out, green_out, blue_out);
                    errors = errors + 1;
                end
                @(negedge clk);
            end
            if (busy || valid || done) errors = errors + 1;
        end
        if (errors == 0) $display("PASS: %0d points", POINTS);
        else             $display("FAIL: %0d errors in %0d points", errors, POINTS);
        $finish;
    end
endmodule
