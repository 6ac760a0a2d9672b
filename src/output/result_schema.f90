!> Result schema: names, widths, units and descriptions of the tables of the result file, and their creation and filling.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A group of columns is a group of the file with one data set per column and the same number of rows in each. The values are
!! passed as two matrices, integers and reals, with the columns one below the other.
module amontons_result_schema
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_INTERNAL
  use amontons_iteration_records, only: N_PHASES
  use amontons_hdf5_file, only: append_rows, create_group, create_table, hdf5_layout_type, open_table, hdf5_file_type, &
    hdf5_table_type, &
    write_data, STORAGE_I32, STORAGE_REAL
  use amontons_virtual_data_sets, only: source_files_type, create_virtual
  implicit none
  private
  public :: result_column_type, create_columns, create_virtual_columns, open_columns, append_columns, write_columns, check_finite
  public :: POINT_COLUMNS, STRUCTURE_COLUMNS, N_POINT_REALS, N_POINT_INTEGERS, STRAIN_COLUMN, INTEGRATION_COLUMNS
  public :: CONTACT_COLUMNS, N_CONTACT_INTEGERS, N_CONTACT_REALS, PAIR_COLUMNS, N_PAIR_INTEGERS, N_PAIR_REALS
  public :: HISTORY_COLUMNS, N_HISTORY_INTEGERS, N_HISTORY_REALS
  public :: field_rows, ITERATION_COLUMNS, N_ITERATION_INTEGERS, N_ITERATION_REALS, STEP_COLUMNS, CONTROL_COLUMNS

  !> A column of a table: a number or a short vector per row.
  type :: result_column_type
    character(20) :: name = ''
    integer :: width = 1
    character(16) :: unit = '[-]'
    character(112) :: description = ''
    logical :: is_integer = .false.
  end type result_column_type

  type(result_column_type), parameter :: POINT_COLUMNS(15) = [ &
    result_column_type('U', 3, '[length]', 'Displacement.'), &
    result_column_type('RF', 3, '[force]', 'Reaction force of supports and equations.'), &
    result_column_type('S', 6, '[stress]', &
      'Cauchy stress xx yy zz xy yz xz, extrapolated to the nodes, mean of the elements.'), &
    result_column_type('E', 6, '[-]', &
      'Strain xx yy zz xy yz xz, tensor shears, as S. Under NLGEOM LE is logarithmic, E is Green''s.'), &
    result_column_type('S_mises', 1, '[stress]', 'Von Mises stress of S at the node.'), &
    result_column_type('CPRESS', 1, '[stress]', 'Pressure on slave nodes: normal force over tributary area; 0 elsewhere.'), &
    result_column_type('CSHEAR', 3, '[stress]', 'Friction on slave nodes: shear force over tributary area; 0 elsewhere.'), &
    result_column_type('COPEN', 1, '[length]', &
      'Gap at slave nodes: open is positive; 0 elsewhere; the size of the model without projection.'), &
    result_column_type('CSLIP', 3, '[length]', 'Slip vector of slave nodes since the start of the job; 0 elsewhere.'), &
    result_column_type('CNORMF', 3, '[force]', 'Contact force on slave nodes, normal part; 0 elsewhere.'), &
    result_column_type('CSHEARF', 3, '[force]', 'Contact force on slave nodes, tangential part; 0 elsewhere.'), &
    result_column_type('PEEQ', 1, '[-]', 'Equivalent plastic strain, as S.'), &
    result_column_type('NT', 1, '[temperature]', 'Temperature.'), &
    result_column_type('CSTATUS', 1, '[-]', 'Status of slave nodes: 0 open, 1 stick, 2 slip; -1 elsewhere.', .true.), &
    result_column_type('CSCENARIO', 1, '[-]', &
      'Slip scenario 1 to 4 of the last iteration that moved the slave node, else 0.', .true.)]
  !> Further columns of a model with shells or beams.
  type(result_column_type), parameter :: STRUCTURE_COLUMNS(3) = [ &
    result_column_type('UR', 3, '[rad]', 'Rotation vector of the fibre or cross-section, of a reference node.'), &
    result_column_type('SF', 6, '[force(/length)]', 'Section forces of shells, per length, and of beams: mean of the elements.'), &
    result_column_type('SM', 3, '[force(*length)]', 'Section moments of shells, per length, and of beams, likewise.')]
  integer, parameter :: N_POINT_INTEGERS = sum(POINT_COLUMNS%width, mask=POINT_COLUMNS%is_integer)
  integer, parameter :: N_POINT_REALS = sum(POINT_COLUMNS%width, mask=.not. POINT_COLUMNS%is_integer)
  integer, parameter :: STRAIN_COLUMN = findloc(POINT_COLUMNS%name, 'E', dim=1)

  type(result_column_type), parameter :: INTEGRATION_COLUMNS(4) = [ &
    result_column_type('S', 6, '[stress]', 'Cauchy stress xx yy zz xy yz xz.'), &
    result_column_type('E', 6, '[-]', &
      'Strain xx yy zz xy yz xz, tensor shear components; NLGEOM: logarithmic (abaqus), Green''s (calculix).'), &
    result_column_type('energy', 1, '[energy/volume]', 'Strain energy per reference volume.'), &
    result_column_type('PEEQ', 1, '[-]', 'Equivalent plastic strain.')]

  type(result_column_type), parameter :: CONTACT_COLUMNS(11) = [ &
    result_column_type('facet', 1, '[-]', &
      'Facet of the master on which the node projects, counted within the pair; -1: none.', .true.), &
    result_column_type('status', 1, '[-]', '0 open, 1 stick, 2 slip.', .true.), &
    result_column_type('scenario', 1, '[-]', '1 to 4 of the last iteration that moved the node, else 0.', .true.), &
    result_column_type('xi', 2, '[-]', 'Natural coordinates of the projection in the facet.'), &
    result_column_type('gap', 1, '[length]', &
      'Signed distance along the normal, negative is penetration; undefined without a facet.'), &
    result_column_type('normal', 3, '[-]', 'Unit normal out of the master.'), &
    result_column_type('force', 3, '[force]', 'Contact force on the slave node, normal part.'), &
    result_column_type('shear', 3, '[force]', 'Contact force on the slave node, tangential part.'), &
    result_column_type('slip', 3, '[length]', 'Slip vector since the start of the job.'), &
    result_column_type('area', 1, '[length^2]', 'Tributary area.'), &
    result_column_type('stiffness', 1, '[force/length]', 'Scale of the trial traction.')]
  integer, parameter :: N_CONTACT_INTEGERS = sum(CONTACT_COLUMNS%width, mask=CONTACT_COLUMNS%is_integer)
  integer, parameter :: N_CONTACT_REALS = sum(CONTACT_COLUMNS%width, mask=.not. CONTACT_COLUMNS%is_integer)

  type(result_column_type), parameter :: PAIR_COLUMNS(12) = [ &
    result_column_type('step', 1, '[-]', 'Step, counted from 1; 0 is the state before the first.', .true.), &
    result_column_type('increment', 1, '[-]', 'Increment in the step, counted from 1.', .true.), &
    result_column_type('pair', 1, '[-]', 'Pair, counted from 0 as in /AMONTONS/pairs.', .true.), &
    result_column_type('n_status', 3, '[-]', 'Its slave nodes or points: open, stick, slip.', .true.), &
    result_column_type('total_time', 1, '[time]', 'Time since the start of the job.'), &
    result_column_type('CFN', 3, '[force]', &
      'Force of the pressure on the slave. Of bodies of revolution x is the sum of radial forces.'), &
    result_column_type('CFS', 3, '[force]', 'Force of the friction on the slave.'), &
    result_column_type('CMN', 3, '[force length]', 'Moment of the pressure about the origin.'), &
    result_column_type('CMS', 3, '[force length]', 'Moment of the friction about the origin.'), &
    result_column_type('CAREA', 1, '[length^2]', 'Area in contact.'), &
    result_column_type('XN', 3, '[length]', 'Centre of the pressure: positions weighted by force magnitude; 0 without forces.'), &
    result_column_type('XS', 3, '[length]', 'Centre of the friction, likewise.')]
  integer, parameter :: N_PAIR_INTEGERS = sum(PAIR_COLUMNS%width, mask=PAIR_COLUMNS%is_integer)
  integer, parameter :: N_PAIR_REALS = sum(PAIR_COLUMNS%width, mask=.not. PAIR_COLUMNS%is_integer)

  type(result_column_type), parameter :: HISTORY_COLUMNS(34) = [ &
    result_column_type('step', 1, '[-]', 'Step, counted from 1; 0 is the state before the first.', .true.), &
    result_column_type('increment', 1, '[-]', 'Increment in the step, counted from 1.', .true.), &
    result_column_type('attempt', 1, '[-]', 'Attempt at the increment, counted from 1.', .true.), &
    result_column_type('is_converged', 1, '[-]', '1: the attempt converged; 0: it was cut back.', .true.), &
    result_column_type('n_iterations', 1, '[-]', 'Newton iterations.', .true.), &
    result_column_type('n_cutbacks', 1, '[-]', 'Attempts at this increment that failed before.', .true.), &
    result_column_type('n_status', 3, '[-]', 'Slave nodes open, stick, slip at the end.', .true.), &
    result_column_type('n_scenario', 4, '[-]', 'Slave nodes in scenario I to IV, summed over iterations.', .true.), &
    result_column_type('n_factorisations', 1, '[-]', 'Factorisations.', .true.), &
    result_column_type('n_krylov', 1, '[-]', 'Krylov iterations.', .true.), &
    result_column_type('n_cycles', 1, '[-]', 'Active-set cycles that were treated.', .true.), &
    result_column_type('n_unpredicted', 1, '[-]', &
      'Slave nodes whose status changed after the first iteration.', .true.), &
    result_column_type('frame', 1, '[-]', 'Frame that holds the fields of this row; -1: not written.', .true.), &
    result_column_type('total_time', 1, '[time]', 'Time since the start of the job, at the end of the increment.'), &
    result_column_type('step_time', 1, '[time]', 'Time since the start of the step, at the end of the increment.'), &
    result_column_type('dt', 1, '[time]', 'Length of the increment.'), &
    result_column_type('smallest_step_length', 1, '[-]', 'Smallest step length of the line search.'), &
    result_column_type('residual', 1, '[-]', &
      'Last largest force imbalance over the largest force; 1e30 if not finite.'), &
    result_column_type('correction', 1, '[-]', &
      'Last largest correction over the largest increment of displacement; 1e30 if not finite.'), &
    result_column_type('seconds', N_PHASES, '[s]', 'Seconds by phase; the phases are named in /AMONTONS/phases.'), &
    result_column_type('applied_force', 3, '[force]', 'Sum of the applied forces.'), &
    result_column_type('reaction_force', 3, '[force]', 'Sum of the reactions of the supports.'), &
    result_column_type('contact_force', 3, '[force]', 'Sum of contact forces on slaves and masters; 0 in equilibrium.'), &
    result_column_type('slave_force', 3, '[force]', 'Sum of the contact forces on the slave nodes.'), &
    result_column_type('external_work', 1, '[energy]', 'Of loads and prescribed displacements since the start of the job.'), &
    result_column_type('friction_work', 1, '[energy]', 'Dissipated by friction since the start of the job.'), &
    result_column_type('strain_energy', 1, '[energy]', 'Stored in the elements.'), &
    result_column_type('contact_energy', 1, '[energy]', 'Stored by compliant laws of contact.'), &
    result_column_type('proximal_work', 1, '[energy]', &
      'Work of unbalanced forces: proximal and snap-through steps, snaps of structures, since the start of the job.'), &
    result_column_type('damped_work', 1, '[energy]', 'Dissipated by the damping of STABILIZE since the start of the job.'), &
    result_column_type('plastic_work', 1, '[energy]', 'Taken by plastic and creep strains since the start of the job.'), &
    result_column_type('kinetic_energy', 1, '[energy]', 'Of the motion in a DYNAMIC step.'), &
    result_column_type('integration_loss', 1, '[energy]', &
      'Dissipated by backward Euler in DYNAMIC steps since the start of the job.'), &
    result_column_type('load_factor', 1, '[-]', 'Load proportionality factor of a RIKS step, else 0.')]
  integer, parameter :: N_HISTORY_INTEGERS = sum(HISTORY_COLUMNS%width, mask=HISTORY_COLUMNS%is_integer)
  integer, parameter :: N_HISTORY_REALS = sum(HISTORY_COLUMNS%width, mask=.not. HISTORY_COLUMNS%is_integer)

  type(result_column_type), parameter :: ITERATION_COLUMNS(16) = [ &
    result_column_type('step', 1, '[-]', 'Step, counted from 1.', .true.), &
    result_column_type('increment', 1, '[-]', 'Increment in the step, counted from 1.', .true.), &
    result_column_type('attempt', 1, '[-]', 'Attempt at the increment, counted from 1.', .true.), &
    result_column_type('iteration', 1, '[-]', 'Newton iteration, counted from 1.', .true.), &
    result_column_type('n_closed', 1, '[-]', 'Slave nodes in contact.', .true.), &
    result_column_type('n_status', 3, '[-]', 'Slave nodes open, stick, slip.', .true.), &
    result_column_type('n_scenario', 4, '[-]', 'Slave nodes in scenario I to IV.', .true.), &
    result_column_type('n_opened', 1, '[-]', 'Slave nodes that opened.', .true.), &
    result_column_type('n_closed_now', 1, '[-]', 'Slave nodes that closed.', .true.), &
    result_column_type('n_krylov', 1, '[-]', 'Krylov iterations.', .true.), &
    result_column_type('n_balanced', 1, '[-]', 'Slave nodes that slip in equilibrium.', .true.), &
    result_column_type('n_rounds', 1, '[-]', 'Corrections of the direction with the bulk linearized.', .true.), &
    result_column_type('residual', 1, '[-]', 'Largest force imbalance over the largest force; 1e30 if not finite.'), &
    result_column_type('correction', 1, '[-]', &
      'Largest correction over the largest increment of displacement; 1e30 if not finite.'), &
    result_column_type('step_length', 1, '[-]', 'Step length of the line search (mean of the nodes for NODAL).'), &
    result_column_type('worst_gap', 1, '[length]', 'Largest penetration or opening of a closed node; 1e30 if not finite.')]
  integer, parameter :: N_ITERATION_INTEGERS = sum(ITERATION_COLUMNS%width, mask=ITERATION_COLUMNS%is_integer)
  integer, parameter :: N_ITERATION_REALS = sum(ITERATION_COLUMNS%width, mask=.not. ITERATION_COLUMNS%is_integer)

  type(result_column_type), parameter :: STEP_COLUMNS(11) = [ &
    result_column_type('is_nlgeom', 1, '[-]', '1: large displacements.', .true.), &
    result_column_type('max_increments', 1, '[-]', 'Most increments.', .true.), &
    result_column_type('is_direct', 1, '[-]', '1: fixed increments.', .true.), &
    result_column_type('line_search', 1, '[-]', 'Line search: 0 none, 1 all, 2 global, 3 nodal, 4 automatic.', .true.), &
    result_column_type('file_frequency', 1, '[-]', 'Every n-th increment, and the last of the step, is a frame.', .true.), &
    result_column_type('print_frequency', 1, '[-]', 'The same for the .dat file.', .true.), &
    result_column_type('dt_initial', 1, '[time]', 'First increment.'), &
    result_column_type('period', 1, '[time]', 'Length of the step.'), &
    result_column_type('dt_min', 1, '[time]', 'Smallest increment.'), &
    result_column_type('dt_max', 1, '[time]', 'Largest increment.'), &
    result_column_type('creep_tolerance', 1, '[-]', 'CETOL; 0: not given.')]

  type(result_column_type), parameter :: CONTROL_COLUMNS(19) = [ &
    result_column_type('i_0', 1, '[-]', &
      'Iteration after which the residuals must fall in two consecutive iterations.', .true.), &
    result_column_type('i_r', 1, '[-]', 'Iteration after which a logarithmic estimate decides to cut back.', .true.), &
    result_column_type('i_p', 1, '[-]', 'Iteration after which the residual tolerance r_p is used.', .true.), &
    result_column_type('i_c', 1, '[-]', 'Most iterations of an increment.', .true.), &
    result_column_type('i_l', 1, '[-]', 'More iterations than this: the next increment is smaller (d_b).', .true.), &
    result_column_type('i_g', 1, '[-]', &
      'At most this many iterations in two consecutive increments: the next increment is larger (d_d).', .true.), &
    result_column_type('i_a', 1, '[-]', 'Most cut-backs of an increment.', .true.), &
    result_column_type('d_f', 1, '[-]', 'Cut-back factor: divergence.'), &
    result_column_type('d_c', 1, '[-]', 'Cut-back factor: too slow.'), &
    result_column_type('d_b', 1, '[-]', 'Factor after slow convergence.'), &
    result_column_type('d_a', 1, '[-]', 'Cut-back factor: CETOL, times what it allows over what was found.'), &
    result_column_type('d_d', 1, '[-]', 'Factor after fast convergence.'), &
    result_column_type('r_n', 1, '[-]', 'Tolerance of the residual over the largest force.'), &
    result_column_type('c_n', 1, '[-]', 'Tolerance of the correction over the largest increment of displacement.'), &
    result_column_type('r_p', 1, '[-]', 'Residual tolerance after i_p iterations.'), &
    result_column_type('r_l', 1, '[-]', 'Residual below which the correction is not checked.'), &
    result_column_type('s_max', 1, '[-]', 'Largest step length of the line search.'), &
    result_column_type('s_min', 1, '[-]', 'Smallest step length of the line search.'), &
    result_column_type('gap_tolerance', 1, '[-]', &
      'Penetration allowed at a closed node over the edge length of its master facet.')]

contains

  !> One growing table per column, in a new group.
  subroutine create_columns(store, folder, columns, n_rows_hint, tables, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: folder              !< full path of the group
    type(result_column_type), intent(in) :: columns(:)
    integer, intent(in) :: n_rows_hint              !< rows added at a time
    type(hdf5_table_type), allocatable, intent(out) :: tables(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    call create_group(store, folder, error)
    allocate (tables(size(columns)))
    do i = 1, size(columns)
      if (allocated(error)) return
      call create_table(store, tables(i), folder // '/' // trim(columns(i)%name), layout_of(columns(i), n_rows_hint), &
        columns(i)%unit, columns(i)%description, error)
    end do
  end subroutine create_columns


  !> The same as virtual data sets that grow with those of other files.
  subroutine create_virtual_columns(store, folder, columns, sources, n_rows, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: folder              !< full path of the group, here and in the sources
    type(result_column_type), intent(in) :: columns(:)
    type(source_files_type), intent(in) :: sources
    integer, intent(in) :: n_rows(:)                !< rows added at a time, of each source
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    call create_group(store, folder, error)
    do i = 1, size(columns)
      if (allocated(error)) return
      call create_virtual(store, sources, n_rows, folder // '/' // trim(columns(i)%name), layout_of(columns(i), 1), .true., &
        columns(i)%unit, columns(i)%description, error)
    end do
  end subroutine create_virtual_columns


  !> Opens the tables of an existing group to append rows.
  subroutine open_columns(store, folder, columns, n_rows_hint, tables, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: folder              !< full path of the group
    type(result_column_type), intent(in) :: columns(:)
    integer, intent(in) :: n_rows_hint              !< rows added at a time
    type(hdf5_table_type), allocatable, intent(out) :: tables(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    allocate (tables(size(columns)))
    do i = 1, size(columns)
      call open_table(store, tables(i), folder // '/' // trim(columns(i)%name), layout_of(columns(i), n_rows_hint), error)
      if (allocated(error)) return
    end do
  end subroutine open_columns


  !> First and last row of a field at the nodes, among the reals or among the integers of POINT_COLUMNS.
  pure function field_rows(name) result(rows)
    character(*), intent(in) :: name                !< as in POINT_COLUMNS
    integer :: rows(2)
    integer :: at
    at = findloc(POINT_COLUMNS%name, name, dim=1)
    rows(1) = 1 + sum(POINT_COLUMNS(:at - 1)%width, mask=POINT_COLUMNS(:at - 1)%is_integer .eqv. POINT_COLUMNS(at)%is_integer)
    rows(2) = rows(1) + POINT_COLUMNS(at)%width - 1
  end function field_rows


  !> Layout of the table of a column.
  pure function layout_of(column, n_rows_hint) result(form)
    type(result_column_type), intent(in) :: column
    integer, intent(in) :: n_rows_hint
    type(hdf5_layout_type) :: form
    form = hdf5_layout_type(storage=merge(STORAGE_I32, STORAGE_REAL, column%is_integer), width=column%width, &
      n_rows_hint=n_rows_hint)
  end function layout_of


  !> Adds rows to all tables of a group of columns. (The brackets make a copy: rows of a matrix are not contiguous.)
  subroutine append_columns(store, columns, integers, reals, tables, error)
    type(hdf5_file_type), intent(in) :: store
    type(result_column_type), intent(in) :: columns(:)
    integer, intent(in) :: integers(:, :)           !< (widths of the integer columns, rows)
    real(DP), intent(in) :: reals(:, :)             !< (widths of the real columns, rows)
    type(hdf5_table_type), intent(inout) :: tables(:)
    type(error_type), allocatable, intent(out) :: error
    integer :: i, n_integers, n_reals
    n_integers = 0
    n_reals = 0
    do i = 1, size(columns)
      associate (width => columns(i)%width)
        if (columns(i)%is_integer) then
          call append_rows(store, tables(i), (integers(n_integers + 1:n_integers + width, :)), error)
          n_integers = n_integers + width
        else
          call append_rows(store, tables(i), (reals(n_reals + 1:n_reals + width, :)), error)
          n_reals = n_reals + width
        end if
      end associate
      if (allocated(error)) return
    end do
  end subroutine append_columns


  !> Columns of width 1 that do not grow, in a new group.
  subroutine write_columns(store, folder, columns, integers, reals, error)
    type(hdf5_file_type), intent(in) :: store
    character(*), intent(in) :: folder              !< full path of the group
    type(result_column_type), intent(in) :: columns(:)
    integer, intent(in) :: integers(:, :)           !< (integer columns, rows)
    real(DP), intent(in) :: reals(:, :)             !< (real columns, rows)
    type(error_type), allocatable, intent(out) :: error
    character(:), allocatable :: name
    integer :: i, n_integers, n_reals
    n_integers = 0
    n_reals = 0
    call create_group(store, folder, error)
    do i = 1, size(columns)
      if (allocated(error)) return
      name = folder // '/' // trim(columns(i)%name)
      if (columns(i)%is_integer) then
        n_integers = n_integers + 1
        call write_data(store, name, (integers(n_integers, :)), columns(i)%unit, columns(i)%description, error)
      else
        n_reals = n_reals + 1
        call write_data(store, name, (reals(n_reals, :)), columns(i)%unit, columns(i)%description, error)
      end if
    end do
  end subroutine write_columns


  !> Sets an error if a value is NaN or infinite: a program error that must not reach the file.
  subroutine check_finite(where, columns, reals, error, index)
    character(*), intent(in) :: where               !< meaning of a row, e.g. 'node'
    type(result_column_type), intent(in) :: columns(:)
    real(DP), intent(in) :: reals(:, :)             !< (widths of the real columns, rows)
    type(error_type), allocatable, intent(out) :: error
    integer, intent(in), optional :: index(:)       !< number of each of the first rows in the model; default: that of the row
    character(12) :: number
    integer :: i, row, n
    if (count(.not. abs(reals) <= huge(1.0_DP)) == 0) return   ! vectorized, unlike ieee_is_finite
    n = 0
    do i = 1, size(columns)
      if (columns(i)%is_integer) cycle
      do row = 1, size(reals, 2)
        if (all(ieee_is_finite(reals(n + 1:n + columns(i)%width, row)))) cycle
        write (number, '(i0)') row
        if (present(index)) then
          if (row <= size(index)) write (number, '(i0)') index(row)
        end if
        call set_error(error, EXIT_INTERNAL, trim(columns(i)%name) // ' is not a finite number at ' // where // ' ' // &
          trim(number) // ' (counted from 1); the increment is not written.')
        return
      end do
      n = n + columns(i)%width
    end do
  end subroutine check_finite

end module amontons_result_schema
