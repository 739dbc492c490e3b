// schlick_tb: self-checking bench of schlick
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s schlick_tb -o sim schlick*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top schlick_tb schlick*.v
//   $ obj_dir/Vschlick_tb
// Inputs change on the falling edge of the clock. The bench compares outputs just before the rising
// edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module schlick_tb #(
    parameter STIMULUS_FILE = "schlick_stimulus.mem",
    parameter EXPECTED_FILE = "schlick_expected.mem"
);
    localparam CLOCKS     = 1704;
    localparam KNOWN_FROM = 18;  // the first clock in which results are compared
    localparam REPORTED   = 20;  // the number of differences to print

    reg [61:0] stimulus [0:CLOCKS-1];
    reg [26:0] expected [0:CLOCKS-1];
    reg [26:0] want;

    reg clk = 1'b0;
    reg         rst_n;
    reg         start;
    reg  [20:0] cos_gamma;
    reg         cos_gamma_write;
    reg  [9:0]  exponent;
    reg         exponent_write;
    reg  [7:0]  red;
    reg         red_write;
    reg  [7:0]  green;
    reg         green_write;
    reg  [7:0]  blue;
    reg         blue_write;
    wire        valid;
    wire        busy;
    wire        done;
    wire [7:0]  red_out;
    wire [7:0]  green_out;
    wire [7:0]  blue_out;

    integer clock;
    // The initial values are set here and not in the process below, because Verilator 5.006 treats
    // a variable as constant after a loop with delays if the process has set it before the loop.
    integer errors = 0;
    reg was_reset = 1'b0;  // the control unit is in a known state

    schlick dut (
        .clk(clk),
        .rst_n(rst_n),
        .start(start),
        .cos_gamma(cos_gamma),
        .cos_gamma_write(cos_gamma_write),
        .exponent(exponent),
        .exponent_write(exponent_write),
        .red(red),
        .red_write(red_write),
        .green(green),
        .green_write(green_write),
        .blue(blue),
        .blue_write(blue_write),
        .valid(valid),
        .busy(busy),
        .done(done),
        .red_out(red_out),
        .green_out(green_out),
        .blue_out(blue_out)
    );

    // Prints the address and the name of the current microinstruction.
    task write_microinstruction;
        begin
            $write("microinstruction ");
            case (dut.control.word_address)
                2'd0: $write("0 (operands <- cos gamma, n)");
                2'd1: $write("1 (quotient <- cos gamma / (n*(1 - cos gamma) + cos gamma))");
                2'd2: $write("2 (next bit of the quotient)");
                2'd3: $write("3 (result)");
                default: $write("unknown");
            endcase
        end
    endtask

    initial begin
        $readmemh(STIMULUS_FILE, stimulus);
        $readmemh(EXPECTED_FILE, expected);
        for (clock = 0; clock < CLOCKS; clock = clock + 1) begin
            {rst_n, start, cos_gamma, cos_gamma_write, exponent, exponent_write, red, red_write,
                    green, green_write, blue, blue_write} = stimulus[clock];
            want = expected[clock];
            #4;
            if (was_reset) begin
                if (valid !== want[26]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": valid is %h, expected %h", valid, want[26]);
                    end
                end
                if (busy !== want[25]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": busy is %h, expected %h", busy, want[25]);
                    end
                end
                if (done !== want[24]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": done is %h, expected %h", done, want[24]);
                    end
                end
            end
            if (clock >= KNOWN_FROM) begin
                if (red_out !== want[23:16]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": red_out is %h, expected %h", red_out, want[23:16]);
                    end
                end
                if (green_out !== want[15:8]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": green_out is %h, expected %h", green_out, want[15:8]);
                    end
                end
                if (blue_out !== want[7:0]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": blue_out is %h, expected %h", blue_out, want[7:0]);
                    end
                end
            end
            if (!rst_n) was_reset = 1'b1;
            #1 clk = 1'b1;
            #5 clk = 1'b0;
        end
        if (errors != 0) begin
            $display("FAIL schlick: %0d differences in %0d clocks", errors, CLOCKS);
            $fatal;
        end
        $display("PASS schlick: %0d clocks, no difference", CLOCKS);
        $finish;
    end
endmodule

`default_nettype wire
