// cosine_squared_tb: self-checking bench of cosine_squared
//
// To run it, copy the files of both folders into one directory and use any simulator, for example
//   $ iverilog -g2012 -s cosine_squared_tb -o sim cosine_squared*.v
//   $ ./sim
// or, with Verilator 5,
//   $ verilator --binary --timing --top cosine_squared_tb cosine_squared*.v
//   $ obj_dir/Vcosine_squared_tb
// Inputs change on the falling edge of the clock. The bench compares outputs just before the rising
// edge.
//
// Generated files belong to their user, without conditions.

`default_nettype none

module cosine_squared_tb #(
    parameter STIMULUS_FILE = "cosine_squared_stimulus.mem",
    parameter EXPECTED_FILE = "cosine_squared_expected.mem"
);
    localparam CLOCKS     = 13369;
    localparam KNOWN_FROM = 7;  // the first clock in which results are compared
    localparam REPORTED   = 20;  // the number of differences to print

    reg [85:0] stimulus [0:CLOCKS-1];
    reg [13:0] expected [0:CLOCKS-1];
    reg [13:0] want;

    reg clk = 1'b0;
    reg                rst_n;
    reg                start;
    reg         [7:0]  amplitude;
    reg                amplitude_write;
    reg  signed [29:0] delta_zeta;
    reg                delta_zeta_write;
    reg  signed [29:0] zeta_start;
    reg                zeta_start_write;
    reg         [11:0] length;
    reg                length_write;
    wire               valid;
    wire               busy;
    wire               done;
    wire               count;
    wire               accumulate;
    wire               write_angle;
    wire        [7:0]  intensity_out;

    integer clock;
    // The initial values are set here and not in the process below, because Verilator 5.006 treats
    // a variable as constant after a loop with delays if the process has set it before the loop.
    integer errors = 0;
    reg was_reset = 1'b0;  // the control unit is in a known state

    cosine_squared dut (
        .clk(clk),
        .rst_n(rst_n),
        .start(start),
        .amplitude(amplitude),
        .amplitude_write(amplitude_write),
        .delta_zeta(delta_zeta),
        .delta_zeta_write(delta_zeta_write),
        .zeta_start(zeta_start),
        .zeta_start_write(zeta_start_write),
        .length(length),
        .length_write(length_write),
        .valid(valid),
        .busy(busy),
        .done(done),
        .count(count),
        .accumulate(accumulate),
        .write_angle(write_angle),
        .intensity_out(intensity_out)
    );

    // Prints the address and the name of the current microinstruction.
    task write_microinstruction;
        begin
            $write("microinstruction ");
            case (dut.control.word_address)
                3'd0: $write("0 (operands)");
                3'd1: $write("1 (angle <- zeta_start: first point)");
                3'd2: $write("2 (angle <- angle + delta_zeta: next point)");
                3'd3: $write("3 (last point follows in one clock)");
                3'd4: $write("4 (last point on the output)");
                default: $write("unknown");
            endcase
        end
    endtask

    initial begin
        $readmemh(STIMULUS_FILE, stimulus);
        $readmemh(EXPECTED_FILE, expected);
        for (clock = 0; clock < CLOCKS; clock = clock + 1) begin
            {rst_n, start, amplitude, amplitude_write, delta_zeta, delta_zeta_write, zeta_start,
                    zeta_start_write, length, length_write} = stimulus[clock];
            want = expected[clock];
            #4;
            if (was_reset) begin
                if (valid !== want[13]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": valid is %h, expected %h", valid, want[13]);
                    end
                end
                if (busy !== want[12]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": busy is %h, expected %h", busy, want[12]);
                    end
                end
                if (done !== want[11]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": done is %h, expected %h", done, want[11]);
                    end
                end
            end
            if (clock >= KNOWN_FROM) begin
                if (count !== want[10]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": count is %h, expected %h", count, want[10]);
                    end
                end
                if (accumulate !== want[9]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": accumulate is %h, expected %h", accumulate, want[9]);
                    end
                end
                if (write_angle !== want[8]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": write_angle is %h, expected %h", write_angle, want[8]);
                    end
                end
                if (intensity_out !== want[7:0]) begin
                    errors = errors + 1;
                    if (errors <= REPORTED) begin
                        $write("clock %0d, ", clock);
                        write_microinstruction;
                        $display(": intensity_out is %h, expected %h", intensity_out, want[7:0]);
                    end
                end
            end
            if (!rst_n) was_reset = 1'b1;
            #1 clk = 1'b1;
            #5 clk = 1'b0;
        end
        if (errors != 0) begin
            $display("FAIL cosine_squared: %0d differences in %0d clocks", errors, CLOCKS);
            $fatal;
        end
        $display("PASS cosine_squared: %0d clocks, no difference", CLOCKS);
        $finish;
    end
endmodule

`default_nettype wire
