!> The rows of surface-to-surface pairs, and of nodes that are slaves of several of them: masters side by side, corners, far ones.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, section 5, "Surface to surface". A pair counts at a node of another one only where it touches or
!! may touch next: an open pair elsewhere changes nothing.
module amontons_mortar_seams
  use amontons_kinds, only: DP
  use amontons_surfaces, only: is_compliant
  use amontons_state, only: slave_state_type, STATUS_OPEN
  use amontons_contact_constraint_rows, only: evaluate_relative_position
  use amontons_shared_slave_nodes, only: are_shared, MIN_PARALLEL_COSINE
  use amontons_mortar, only: integrate_mortar, mark_row_at_seam, build_rows, end_rows_at_edges, merge_rows, vertices_of, &
    find_mean_distance
  use amontons_contact_pairs, only: contact_type
  implicit none
  private
  public :: update_mortar_rows

  integer, parameter :: SEAM_UNKNOWN = 0         !< a node was over one master only in this increment
  integer, parameter :: SEAM_COPLANAR = 1        !< its masters are coplanar: the surface continues
  integer, parameter :: SEAM_STEP = 2            !< they are not
  real(DP), parameter :: MAX_COPLANAR_OFFSET = 1.0e-2_DP         !< masters with a larger offset, over an edge, are not coplanar [-]
  real(DP), parameter :: MIN_SAME_SIDE_COSINE = 0.5_DP   !< slave normals with a larger product are of one side of a body [-]
  real(DP), parameter :: MAX_SEAM_DISTANCE = 1.0_DP      !< a master farther than another one by more edges is not beside it [-]

contains

  !> Updates the rows of mortar pairs at x. A node that is slave in several of them with the same normal gets one merged row, in the
  !! first of the pairs, if the masters are coplanar there at the start of the increment.
  subroutine update_mortar_rows(contact, slaves, is_wanted, is_start, x, is_apart)
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    logical, intent(in) :: is_wanted(:)            !< (n_pairs)
    logical, intent(in) :: is_start                !< start of an increment
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    logical, intent(in), optional :: is_apart(:)   !< (n_slaves) of `find_slaves_apart`, where the elements are linearised
    logical, allocatable :: are_apart(:)           ! the same by rows of a pair
    integer :: p, s
    logical :: is_found, is_shared(size(is_wanted))
    do s = 1, size(slaves)
      if (slaves(s)%row > 0 .and. slaves(s)%slave_facet == 0) contact%mortar(slaves(s)%pair)%was_closed(slaves(s)%row) = &
        slaves(s)%status /= STATUS_OPEN .and. .not. contact%has_fixed_geometry(slaves(s)%pair)
    end do
    contact%mortar%is_compliant = is_compliant(contact%laws)
    do p = 1, size(is_wanted)
      if (.not. is_wanted(p)) cycle
      if (is_start) contact%mortar(p)%has_other_masters = are_shared(contact%shared_slaves, contact%mortar(p)%nodes, &
        allocated(contact%facets(p)%unseen))
      if (present(is_apart)) are_apart = rows_apart(p)
      call integrate_mortar(contact%mortar(p), contact%facets(p), contact%search(p), is_start, x, contact%reach(p), are_apart)
    end do
    if (.not. contact%shared_slaves%has_multi_pair_nodes .or. count(is_wanted) < 2) return
    is_shared = is_wanted .and. .not. contact%mortar%has_unique_slaves
    if (is_start) contact%seam = SEAM_UNKNOWN
    if (is_start) call find_other_masters(contact, slaves)
    is_found = is_start
    if (.not. is_start) call mark_second_masters(contact, slaves, is_wanted, is_found)
    if (is_found .and. .not. is_start) call rebuild()
    call merge_rows_at_seams(contact, slaves, is_wanted, x)
    if (.not. is_found) return
    do p = 1, size(is_wanted)
      if (is_shared(p)) call end_rows_at_edges(contact%mortar(p), is_start)
    end do
    call rebuild()
    call merge_rows_at_seams(contact, slaves, is_wanted, x)

  contains

    !> The rows of a pair whose slaves stay open.
    pure function rows_apart(p) result(rows)
      integer, intent(in) :: p                     !< pair
      logical :: rows(size(contact%mortar(p)%nodes))
      integer :: s
      rows = .false.
      do s = 1, size(slaves)
        if (slaves(s)%pair == p .and. slaves(s)%row > 0) rows(slaves(s)%row) = is_apart(s)
      end do
    end function rows_apart

    !> The rows of all pairs that share slave nodes.
    subroutine rebuild()
      do p = 1, size(is_wanted)
        if (is_shared(p)) call build_rows(contact%mortar(p), contact%facets(p), contact%search(p), x, contact%reach(p))
      end do
    end subroutine rebuild

  end subroutine update_mortar_rows


  !> Which nodes of several pairs have a master in another one at the start of the increment, and touch it or may. Without one a
  !! single pair acts on them, and its rows are those of a single pair. In self contact the masters change with the side that is
  !! slave: all may touch.
  subroutine find_other_masters(contact, slaves)
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    integer :: n, i, k
    do n = 1, size(contact%shared_slaves%first) - 1
      associate (own => contact%shared_slaves%member(contact%shared_slaves%first(n):contact%shared_slaves%first(n + 1) - 1))
        if (size(own) < 2) cycle
        do i = 1, size(own)
          if (.not. is_single_sided(contact, slaves(own(i)))) cycle
          contact%mortar(slaves(own(i))%pair)%has_other_masters(slaves(own(i))%row) = &
            any([(k /= i .and. may_touch(contact, slaves, own(i), own(k)), k=1, size(own))])
        end do
      end associate
    end do
  end subroutine find_other_masters


  !> Whether another slave of the node of a slave counts there: it is closed, it is on its master, or it is of the same side of the
  !! body and its master is beside that of the slave, so that both may be one surface.
  pure logical function may_touch(contact, slaves, s, t)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    integer, intent(in) :: s, t                    !< slave, and another one of its node
    associate (pair => slaves(t)%pair, row => slaves(t)%row)
      may_touch = .true.
      if (.not. is_single_sided(contact, slaves(t))) return   ! unknown at nodes
      may_touch = contact%mortar(pair)%places(row)%vertex > 0 .and. .not. contact%is_removed(pair)
      if (.not. may_touch .or. slaves(t)%status /= STATUS_OPEN) return
      may_touch = distance(contact, slaves(t)) <= MAX_COPLANAR_OFFSET * contact%edge(pair)
      if (may_touch .or. dot_product(contact%slave_normal(:, s), contact%slave_normal(:, t)) < MIN_SAME_SIDE_COSINE) return
      may_touch = distance(contact, slaves(t)) <= max(distance(contact, slaves(s)), 0.0_DP) + MAX_SEAM_DISTANCE * contact%edge(pair)
    end associate
  end function may_touch


  !> The distance of the nearest faces around a slave from its master; 0 where none is over it [length].
  pure real(DP) function distance(contact, slave)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave    !< with a row
    integer, allocatable :: vertices(:)
    integer :: i
    associate (mortar => contact%mortar(slave%pair))
      vertices = vertices_of(mortar, slave%row)
      vertices = pack(vertices, mortar%cuts%area(vertices) > 0.0_DP)
      distance = 0.0_DP
      if (size(vertices) > 0) distance = minval([(find_mean_distance(mortar, vertices(i)), i=1, size(vertices))])
      distance = distance + slave%offset
    end associate
  end function distance


  !> Whether a slave has a row in a pair of two surfaces.
  pure logical function is_single_sided(contact, slave)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: slave
    is_single_sided = slave%row > 0 .and. .not. allocated(contact%facets(slave%pair)%unseen)
  end function is_single_sided


  !> Marks the rows of nodes that come over a second master within the increment: they continue for the comparison of both masters.
  subroutine mark_second_masters(contact, slaves, is_wanted, is_found)
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    logical, intent(in) :: is_wanted(:)            !< (n_pairs)
    logical, intent(out) :: is_found
    integer :: n, i
    is_found = .false.
    do n = 1, size(contact%shared_slaves%first) - 1
      associate (own => contact%shared_slaves%member(contact%shared_slaves%first(n):contact%shared_slaves%first(n + 1) - 1))
        if (size(own) < 2) cycle
        if (all(contact%seam(own(2:)) /= SEAM_UNKNOWN)) cycle
        if (.not. any([(are_over_masters(contact, slaves([own(i)]), is_wanted), i=1, size(own))])) cycle
        do i = 1, size(own)
          if (.not. is_wanted(slaves(own(i))%pair)) cycle
          call mark_row_at_seam(contact%mortar(slaves(own(i))%pair), slaves(own(i))%row, is_found)
        end do
      end associate
    end do
  end subroutine mark_second_masters


  !> Whether slaves at a node have rows over their masters.
  pure logical function are_over_masters(contact, own, is_wanted) result(are_over)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: own(:)
    logical, intent(in) :: is_wanted(:)            !< (n_pairs)
    integer :: i
    are_over = all(is_wanted(own%pair))
    if (are_over) are_over = all([(contact%mortar(own(i)%pair)%places(own(i)%row)%vertex > 0, i=1, size(own))])
  end function are_over_masters


  !> Merges the rows of all nodes in several pairs where the masters are coplanar. They are compared once in an increment, where a
  !! node is first over both.
  subroutine merge_rows_at_seams(contact, slaves, is_wanted, x)
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: slaves(:)
    logical, intent(in) :: is_wanted(:)            !< (n_pairs)
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    integer :: n, i, j
    do n = 1, size(contact%shared_slaves%first) - 1
      associate (own => contact%shared_slaves%member(contact%shared_slaves%first(n):contact%shared_slaves%first(n + 1) - 1))
        do j = 2, size(own)
          do i = 1, merge(j - 1, 0, contact%seam(own(j)) == SEAM_UNKNOWN)
            if (are_over_masters(contact, slaves([own(i), own(j)]), is_wanted)) contact%seam(own(j)) = &
              max(contact%seam(own(j)), compared(contact, slaves(own(i)), slaves(own(j)), x))
          end do
          do i = 1, merge(j - 1, 0, contact%seam(own(j)) == SEAM_COPLANAR)
            if (are_over_masters(contact, slaves([own(i), own(j)]), is_wanted)) &
              call merge_slaves(contact, slaves(own(i)), slaves(own(j)))
          end do
        end do
      end associate
    end do
  end subroutine merge_rows_at_seams


  !> SEAM_COPLANAR if the masters of two slaves at a node are coplanar there: their gaps are equal; else SEAM_STEP.
  pure integer function compared(contact, s, t, x) result(seam)
    type(contact_type), intent(in) :: contact
    type(slave_state_type), intent(in) :: s, t     !< both over their masters
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    associate (a => contact%mortar(s%pair), b => contact%mortar(t%pair))
      seam = merge(SEAM_COPLANAR, SEAM_STEP, abs(s%offset + dot_product(a%places(s%row)%normal, &
        evaluate_relative_position(a%rows(s%row), x)) - t%offset - dot_product(b%places(t%row)%normal, &
        evaluate_relative_position(b%rows(t%row), x))) <= MAX_COPLANAR_OFFSET * min(contact%edge(s%pair), contact%edge(t%pair)))
    end associate
  end function compared


  !> Merges the rows of two slaves at a node.
  subroutine merge_slaves(contact, s, t)
    type(contact_type), intent(inout) :: contact
    type(slave_state_type), intent(in) :: s, t
    if (any(contact%is_removed([s%pair, t%pair]))) return
    associate (a => contact%mortar(s%pair)%places(s%row), b => contact%mortar(t%pair)%places(t%row))
      if (dot_product(a%normal, b%normal) <= MIN_PARALLEL_COSINE) return
    end associate
    call merge_rows(contact%mortar(s%pair), s%row, contact%mortar(t%pair), t%row)
  end subroutine merge_slaves

end module amontons_mortar_seams
