// rsqrt_tb: self-checking bench of rsqrt
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s rsqrt_tb -o sim rsqrt*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top rsqrt_tb rsqrt*.v
//   $ obj_dir/Vrsqrt_tb
// Inputs change on the falling edge of the clock. The bench compares outputs just before the rising
// edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module rsqrt_tb #(
    parameter STIMULUS_FILE = "rsqrt_stimulus.mem",
    parameter EXPECTED_FILE = "rsqrt_expected.mem"
);
    localparam CLOCKS     = 564;
    localparam KNOWN_FROM = 8;  // the first clock in which results are compared
    localparam REPORTED   = 20;  // the number of differences to print

    reg [19:0] stimulus [0:CLOCKS-1];
    reg [19:0] expected [0:CLOCKS-1];
    reg [19:0] want;

    reg clk = 1'b0;
    reg         rst_n;
    reg         start;
    reg  [16:0] x;
    reg         x_write;
    wire        valid;
    wire        busy;
    wire        done;
    wire [16:0] result_out;

    integer clock;
    // The initial values are set here and not in the process below, because Verilator 5.006 treats
    // a variable as constant after a loop with delays if the process has set it before the loop.
    integer errors = 0;
    reg was_reset = 1'b0;  // the control unit is in a known state

    rsqrt dut (
        .clk(clk),
        .rst_n(rst_n),
        .start(start),
        .x(x),
        .x_write(x_write),
        .valid(valid),
        .busy(busy),
        .done(done),
        .result_out(result_out)
    );

    // Prints the address and the name of the current microinstruction.
    task write_microinstruction;
        begin
            $write("microinstruction ");
            case (dut.control.word_address)
                2'd0: $write("0 (operand; table addressed)");
                2'd1: $write("1 (sum1 <- coefficients from 1 on)");
                2'd2: $write("2 (result <- the polynomial)");
                2'd3: $write("3 (result)");
                default: $write("unknown");
            endcase
        end
    endtask

    initial begin
        $readmemh(STIMULUS_FILE, stimulus);
        $readmemh(EXPECTED_FILE, expected);
        for (clock = 0; clock < CLOCKS; clock = clock + 1) begin
            {rst_n, start, x, x_write} = stimulus[clock];
            want = expected[clock];
            #4;
            if (was_reset) begin
                if (valid !== want[19]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": valid is %h, expected %h", valid, want[19]);
                    end
                end
                if (busy !== want[18]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": busy is %h, expected %h", busy, want[18]);
                    end
                end
                if (done !== want[17]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": done is %h, expected %h", done, want[17]);
                    end
                end
            end
            if (clock >= KNOWN_FROM) begin
                if (result_out !== want[16:0]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": result_out is %h, expected %h", result_out, want[16:0]);
                    end
                end
            end
            if (!rst_n) was_reset = 1'b1;
            #1 clk = 1'b1;
            #5 clk = 1'b0;
        end
        if (errors != 0) begin
            $display("FAIL rsqrt: %0d differences in %0d clocks", errors, CLOCKS);
            $fatal;
        end
        $display("PASS rsqrt: %0d clocks, no difference", CLOCKS);
        $finish;
    end
endmodule

`default_nettype wire
