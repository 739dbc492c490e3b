// threshold_pipelined_tb: self-checking bench of threshold_pipelined
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s threshold_pipelined_tb -o sim threshold_pipelined*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top threshold_pipelined_tb threshold_pipelined*.v
//   $ obj_dir/Vthreshold_pipelined_tb
// Inputs change on the falling edge of the clock. The bench compares outputs just before the rising
// edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module threshold_pipelined_tb #(
    parameter STIMULUS_FILE = "threshold_pipelined_stimulus.mem",
    parameter EXPECTED_FILE = "threshold_pipelined_expected.mem"
);
    localparam CLOCKS     = 5973;
    localparam KNOWN_FROM = 12;  // the first clock in which results are compared
    localparam REPORTED   = 20;  // the number of differences to print

    reg [57:0] stimulus [0:CLOCKS-1];
    reg [25:0] expected [0:CLOCKS-1];
    reg [25:0] want;

    reg clk = 1'b0;
    reg         rst_n;
    reg         in_valid;
    reg  [20:0] cos_gamma;
    reg  [9:0]  exponent;
    reg  [7:0]  red;
    reg  [7:0]  green;
    reg  [7:0]  blue;
    reg         out_ready;
    wire        in_ready;
    wire        out_valid;
    wire [7:0]  red_out;
    wire [7:0]  green_out;
    wire [7:0]  blue_out;

    integer clock;
    // The initial values are set here and not in the process below, because Verilator 5.006 treats
    // a variable as constant after a loop with delays if the process has set it before the loop.
    integer errors = 0;
    reg was_reset = 1'b0;  // the control unit is in a known state

    threshold_pipelined dut (
        .clk(clk),
        .rst_n(rst_n),
        .in_valid(in_valid),
        .cos_gamma(cos_gamma),
        .exponent(exponent),
        .red(red),
        .green(green),
        .blue(blue),
        .out_ready(out_ready),
        .in_ready(in_ready),
        .out_valid(out_valid),
        .red_out(red_out),
        .green_out(green_out),
        .blue_out(blue_out)
    );

    initial begin
        $readmemh(STIMULUS_FILE, stimulus);
        $readmemh(EXPECTED_FILE, expected);
        for (clock = 0; clock < CLOCKS; clock = clock + 1) begin
            {rst_n, in_valid, cos_gamma, exponent, red, green, blue, out_ready} = stimulus[clock];
            want = expected[clock];
            #4;
            if (was_reset) begin
                if (in_ready !== want[25]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d", clock);
                        $display(": in_ready is %h, expected %h", in_ready, want[25]);
                    end
                end
                if (out_valid !== want[24]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d", clock);
                        $display(": out_valid is %h, expected %h", out_valid, want[24]);
                    end
                end
            end
            if (clock >= KNOWN_FROM && want[24]) begin
                if (red_out !== want[23:16]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d", clock);
                        $display(": red_out is %h, expected %h", red_out, want[23:16]);
                    end
                end
                if (green_out !== want[15:8]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d", clock);
                        $display(": green_out is %h, expected %h", green_out, want[15:8]);
                    end
                end
                if (blue_out !== want[7:0]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d", clock);
                        $display(": blue_out is %h, expected %h", blue_out, want[7:0]);
                    end
                end
            end
            if (!rst_n) was_reset = 1'b1;
            #1 clk = 1'b1;
            #5 clk = 1'b0;
        end
        if (errors != 0) begin
            $display("FAIL threshold_pipelined: %0d differences in %0d clocks", errors, CLOCKS);
            $fatal;
        end
        $display("PASS threshold_pipelined: %0d clocks, no difference", CLOCKS);
        $finish;
    end
endmodule

`default_nettype wire
