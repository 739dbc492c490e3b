// rsqrt_pipelined_tb: self-checking bench of rsqrt_pipelined
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s rsqrt_pipelined_tb -o sim rsqrt_pipelined*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top rsqrt_pipelined_tb rsqrt_pipelined*.v
//   $ obj_dir/Vrsqrt_pipelined_tb
// Inputs change on the falling edge of the clock. The bench compares outputs just before the rising
// edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module rsqrt_pipelined_tb #(
    parameter STIMULUS_FILE = "rsqrt_pipelined_stimulus.mem",
    parameter EXPECTED_FILE = "rsqrt_pipelined_expected.mem"
);
    localparam CLOCKS     = 4104;
    localparam KNOWN_FROM = 9;  // the first clock in which results are compared
    localparam REPORTED   = 20;  // the number of differences to print

    reg [19:0] stimulus [0:CLOCKS-1];
    reg [18:0] expected [0:CLOCKS-1];
    reg [18:0] want;

    reg clk = 1'b0;
    reg         rst_n;
    reg         in_valid;
    reg  [16:0] x;
    reg         out_ready;
    wire        in_ready;
    wire        out_valid;
    wire [16:0] result_out;

    integer clock;
    // The initial values are set here and not in the process below, because Verilator 5.006 treats
    // a variable as constant after a loop with delays if the process has set it before the loop.
    integer errors = 0;
    reg was_reset = 1'b0;  // the control unit is in a known state

    rsqrt_pipelined dut (
        .clk(clk),
        .rst_n(rst_n),
        .in_valid(in_valid),
        .x(x),
        .out_ready(out_ready),
        .in_ready(in_ready),
        .out_valid(out_valid),
        .result_out(result_out)
    );

    initial begin
        $readmemh(STIMULUS_FILE, stimulus);
        $readmemh(EXPECTED_FILE, expected);
        for (clock = 0; clock < CLOCKS; clock = clock + 1) begin
            {rst_n, in_valid, x, out_ready} = stimulus[clock];
            want = expected[clock];
            #4;
            if (was_reset) begin
                if (in_ready !== want[18]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d", clock);
                        $display(": in_ready is %h, expected %h", in_ready, want[18]);
                    end
                end
                if (out_valid !== want[17]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d", clock);
                        $display(": out_valid is %h, expected %h", out_valid, want[17]);
                    end
                end
            end
            if (clock >= KNOWN_FROM && want[17]) begin
                if (result_out !== want[16:0]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d", clock);
                        $display(": result_out is %h, expected %h", result_out, want[16:0]);
                    end
                end
            end
            if (!rst_n) was_reset = 1'b1;
            #1 clk = 1'b1;
            #5 clk = 1'b0;
        end
        if (errors != 0) begin
            $display("FAIL rsqrt_pipelined: %0d differences in %0d clocks", errors, CLOCKS);
            $fatal;
        end
        $display("PASS rsqrt_pipelined: %0d clocks, no difference", CLOCKS);
        $finish;
    end
endmodule

`default_nettype wire
